"""The settings of a training, as a plain dataclass.

The module imports nothing slow, because every command imports it first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import FIRST_TRAINING_SEED
from sarah.episode.tasks import task_named
from sarah.errors import ConfigurationError, check_range, shortened
from sarah.runs.agent_settings import AGENT_SETTINGS, AgentSettings, LearnerSettings, settings_of

MOST_EPISODES = 1_000_000
MOST_SLOTS = 10_000

EPISODES_PER_CANDIDATE = 5
"""Number of episodes per candidate in the comparison at the end of a training."""
BUDGET_PER_CANDIDATE = 50
"""Number of episodes of a training for each candidate: a tenth of them goes into the comparison."""

ALGORITHMS = tuple(AGENT_SETTINGS)
AGENTS = tuple(algo for algo, settings in AGENT_SETTINGS.items() if issubclass(settings, LearnerSettings))
"""Algorithms of reinforcement learning, with networks."""
OPTIMISERS = tuple(algo for algo in ALGORITHMS if algo not in AGENTS)
"""Black-box optimisers, which see returns only."""


@dataclass(frozen=True)
class TrainingConfig:
    """The settings of a training.

    :param task: task: ``stepping`` learns P1 to P5 of the pattern generator, as the paper's First Training; ``balance``
        learns V1 to V4 of the hip law under pushes, as its Second Training
    :param algo: algorithm: {agents}, which learn with networks, or an optimiser that sees returns only: {optimisers}
    :param episodes: budget of the training; an episode is one action of the agent, and up to 30 s of the robot
    :param seed: seed of the training and of all its episodes
    :param slots: number of episodes that are simulated at the same time: an action is chosen without the outcomes of
        the slots - 1 episodes before it. It changes the result of a training; the number of workers does not
    :param agent: settings of the algorithm; by default the algorithm's own
    :param episode: settings of the episodes; by default the task's own
    :param pictures: number of episodes between pictures of the recommendation for TensorBoard: a gait cycle, and a
        video of 3 s. Each takes some seconds, and changes no result; 0 for none
    """

    task: str = "stepping"
    algo: str = "naf"
    episodes: int = 100
    seed: int = 0
    slots: int = 4
    agent: AgentSettings = None  # type: ignore[assignment]  # the algorithm's own
    episode: EpisodeConfig = None  # type: ignore[assignment]  # the task's own
    pictures: int = 0

    def __post_init__(self) -> None:
        """Refuse unknown names and impossible budgets."""
        task, settings = task_named(self.task), settings_of(self.algo)
        object.__setattr__(self, "episode", task.episode if self.episode is None else task.checked_config(self.episode))
        object.__setattr__(self, "agent", settings() if self.agent is None else self.agent)
        if type(self.agent) is not settings:
            raise ConfigurationError(
                f"agent must be the {settings.__name__} of algo {self.algo!r}, not {type(self.agent).__name__}"
            )
        check_range("episodes", self.episodes, 1, MOST_EPISODES)
        check_range("slots", self.slots, 1, MOST_SLOTS)
        check_range("pictures", self.pictures, 0, MOST_EPISODES)
        if not 0 <= self.seed < FIRST_TRAINING_SEED:
            last = FIRST_TRAINING_SEED - 1
            raise ConfigurationError(f"seed must be between 0 and {last}, not {shortened(self.seed)}")
        self.episode.check_for_training()

    @classmethod
    def field_types(cls, content: Mapping[str, Any]) -> dict[str, type]:
        """Types of fields that depend on other fields.

        :param content: values of some fields, as a file gives them
        :raises ConfigurationError: if they name no task or no algorithm
        """
        task, algo = content.get("task", cls.task), content.get("algo", cls.algo)
        types: dict[str, type] = {}
        if isinstance(task, str):  # otherwise its own type is refused
            types["episode"] = type(task_named(task).episode)
        if isinstance(algo, str):
            types["agent"] = settings_of(algo)
        return types

    @property
    def candidate_count(self) -> int:
        """Number of candidates that the budget allows to compare at the end; with one there is no comparison."""
        return max(1, self.episodes // BUDGET_PER_CANDIDATE)

    @property
    def compared_episodes(self) -> int:
        """Number of episodes in the comparison of candidates, which are the last of the budget."""
        return self.candidate_count * EPISODES_PER_CANDIDATE if self.candidate_count > 1 else 0


TrainingConfig.__doc__ = (  # the help of the commands and the page of settings read it
    str(TrainingConfig.__doc__)
    .replace("{agents}", ", ".join(f"``{algo}``" for algo in AGENTS))
    .replace("{optimisers}", ", ".join(f"``{algo}``" for algo in OPTIMISERS))
)
