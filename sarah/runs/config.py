"""What an experiment's settings are: plain dataclasses.

Light on purpose: commands import it before anything slow.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, get_type_hints

from sarah.episode.push import Push
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeConfig
from sarah.episode.tasks import BALANCE, TASKS
from sarah.errors import ConfigurationError, check_range, shortened, unknown_name
from sarah.runs.agent_settings import AGENT_SETTINGS, AgentSettings, LearnerSettings, settings_of

MOST_SIMULATIONS = 1_000_000
MOST_SLOTS = 10_000

SIMULATIONS_PER_CANDIDATE = 5
"""In the comparison that ends a training."""
BUDGET_PER_CANDIDATE = 50
"""Simulations of the whole training for each candidate: a tenth of them goes into the comparison."""

ALGORITHMS = tuple(AGENT_SETTINGS)
AGENTS = tuple(algo for algo, settings in AGENT_SETTINGS.items() if issubclass(settings, LearnerSettings))
"""Algorithms that learn by reinforcement, with networks."""
SEARCHERS = tuple(algo for algo in ALGORITHMS if algo not in AGENTS)
"""Black-box optimisers."""


@dataclass(frozen=True)
class TrainingConfig:
    """A training: what ``sarah-train`` does.

    :param task: what to learn: ``stepping`` is the paper's first training, P1 to P5, and ``balance`` its
        second, V1 to V4
    :param algo: what learns: ``naf``, stable-baselines3's ``td3``, ``sac`` or ``ddpg``, or an optimiser that only sees
        returns: ``cma-es``, ``gp`` (Gaussian process), ``tpe`` or ``random``
    :param simulations: budget; every simulation is one action of the agent and up to 30 s of the robot
    :param seed: of the training and of all its episodes
    :param slots: episodes in flight: each action is chosen knowing all outcomes but those of the slots - 1 before
        it. Another number is another training; the number of workers is not
    :param agent: Settings of the algorithm; by default its own defaults
    :param episode: settings of the episodes
    """

    task: str = "stepping"
    algo: str = "naf"
    simulations: int = 100
    seed: int = 0
    slots: int = 4
    agent: AgentSettings = None  # type: ignore[assignment]  # which are the default depends on algo
    episode: EpisodeConfig = EpisodeConfig()

    def __post_init__(self) -> None:
        """Refuse unknown names and impossible budgets."""
        if self.task not in TASKS:
            raise ConfigurationError(unknown_name("task", self.task, TASKS))
        settings = settings_of(self.algo)
        if self.agent is None:
            object.__setattr__(self, "agent", settings())
        if type(self.agent) is not settings:
            raise ConfigurationError(
                f"agent must be the {settings.__name__} of algo {self.algo!r}, not {type(self.agent).__name__}"
            )
        check_range("simulations", self.simulations, 1, MOST_SIMULATIONS)
        check_range("slots", self.slots, 1, MOST_SLOTS)
        if not 0 <= self.seed < FIRST_TRAINING_SEED:
            raise ConfigurationError(
                f"seed must be between 0 and {FIRST_TRAINING_SEED - 1}, not {shortened(self.seed)}"
            )
        push, limit = self.episode.push, self.episode.time_limit
        if self.task != BALANCE.name and push != Push():
            raise ConfigurationError(f"episode.push is for task {BALANCE.name!r}: {self.task!r} has no push")
        if self.task == BALANCE.name and push.at_seconds[0] >= limit:
            raise ConfigurationError(
                f"episode.push.at_seconds must begin before the time_limit of {limit:g} s, not {push.at_seconds!r}"
            )

    @classmethod
    def field_types(cls, content: Mapping[str, Any]) -> dict[str, Any]:
        """Types of the fields, where those of one depend on the value of another.

        :param content: Values of some fields, by name
        :raises ConfigurationError: for an unknown algorithm
        """
        algo = content.get("algo", cls.algo)
        return get_type_hints(cls) | ({"agent": settings_of(algo)} if isinstance(algo, str) else {})

    @property
    def candidate_count(self) -> int:
        """How many candidates the budget affords to compare at the end; with one, there is nothing to compare."""
        return max(1, self.simulations // BUDGET_PER_CANDIDATE)

    @property
    def compared_simulations(self) -> int:
        """How many simulations the comparison of candidates takes, at the end of the budget."""
        return self.candidate_count * SIMULATIONS_PER_CANDIDATE if self.candidate_count > 1 else 0
