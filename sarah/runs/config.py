"""The settings of a training, as a plain dataclass.

The module imports nothing slow, because every command imports it first.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any

from sarah.episode.from_mapping import convert_fields
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import FIRST_TRAINING_SEED
from sarah.episode.tasks import STEPPING, TASKS, Task, task_named
from sarah.errors import ConfigurationError, check_extended_from
from sarah.ranges import Within, check_ranges
from sarah.runs.agent_settings import AGENT_SETTINGS, AgentSettings, LearnerSettings, NAFSettings, settings_of

MOST_EPISODES = 1_000_000
MOST_SLOTS = 10_000

ALGORITHMS = tuple(AGENT_SETTINGS)
AGENTS = tuple(algo for algo, settings in AGENT_SETTINGS.items() if issubclass(settings, LearnerSettings))
"""Algorithms of reinforcement learning, with networks."""
OPTIMISERS = tuple(algo for algo in ALGORITHMS if algo not in AGENTS)
"""Black-box optimisers, which see returns only."""


@dataclass(frozen=True)
class TrainingConfig:
    """The settings of a training.

    :param task: task: {tasks}, or ``my_task.py:JUMP`` for the task JUMP of a file of yours
    :param algo: algorithm: {agents}, which learn with networks, or an optimiser that sees returns only: {optimisers}
    :param episodes: budget of the training; an episode is one action of the agent, and up to 30 s of the robot
    :param seed: seed of the training and of all its episodes
    :param slots: number of episodes that are simulated at the same time: an action is chosen without the outcomes of
        the slots - 1 episodes before it. It changes the result of a training; the number of workers does not
    :param agent: settings of the algorithm; by default the algorithm's own
    :param episode: settings of the episodes; by default the task's own
    :param extended_from: budgets before the training was made longer, in rising order; --resume with more episodes adds
        one
    :param pictures: number of episodes between pictures of the recommendation for TensorBoard: a gait cycle, and a
        video of 3 s. Each takes some seconds, and changes no result; 0 for none
    """

    task: Task[Any] = STEPPING
    algo: str = "naf"
    episodes: Annotated[int, Within(1, MOST_EPISODES)] = 100
    seed: Annotated[int, Within(0, FIRST_TRAINING_SEED - 1)] = 0
    slots: Annotated[int, Within(1, MOST_SLOTS)] = 4
    agent: AgentSettings = None  # type: ignore[assignment]  # the algorithm's own
    episode: EpisodeConfig = None  # type: ignore[assignment]  # the task's own
    extended_from: tuple[int, ...] = ()
    pictures: Annotated[int, Within(0, MOST_EPISODES)] = 0

    if TYPE_CHECKING:  # arguments may be what __post_init__ converts

        def __init__(
            self,
            task: str | Task[Any] = ...,
            algo: str = ...,
            episodes: int = ...,
            seed: int = ...,
            slots: int = ...,
            agent: AgentSettings | None = ...,
            episode: EpisodeConfig | None = ...,
            extended_from: tuple[int, ...] = ...,
            pictures: int = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Refuse unknown names and impossible budgets."""
        task, settings = task_named(self.task), settings_of(self.algo)
        object.__setattr__(self, "task", task)
        object.__setattr__(self, "episode", task.episode if self.episode is None else task.checked_config(self.episode))
        object.__setattr__(self, "agent", settings() if self.agent is None else self.agent)
        if type(self.agent) is not settings:
            raise ConfigurationError(
                f"agent must be the {settings.__name__} of algo {self.algo!r}, not {type(self.agent).__name__}"
            )
        convert_fields(self)
        check_ranges("", self)
        check_extended_from(self.extended_from, "episodes", self.episodes)
        self.episode.check_for_training()

    def dependent_defaults(self, content: Mapping[str, Any]) -> dict[str, Any]:
        """Values of fields that depend on other fields: the settings of the task's episodes, and of the algorithm.

        :param content: new values of some fields, as a file gives them
        :raises ConfigurationError: if they name no task or no algorithm
        """
        task, algo, agent = content.get("task", self.task), content.get("algo", self.algo), content.get("agent")
        defaults: dict[str, Any] = {}
        if isinstance(task, (str, Task)):  # otherwise its own type is refused
            defaults["episode"] = task_named(task).episode
        if isinstance(algo, str):
            settings = settings_of(algo)()
            preset = agent.get("preset") if isinstance(agent, Mapping) else None
            if isinstance(settings, NAFSettings) and isinstance(preset, str):
                settings = settings.with_preset(preset)
            defaults["agent"] = settings
        return defaults

    @property
    def stages(self) -> tuple[int, ...]:
        """Budgets at which the training ends, or has ended before it was extended."""
        return (*self.extended_from, self.episodes)

    def extended_to(self, episodes: int) -> TrainingConfig:
        """The training with a larger budget: it goes on from where it ended.

        :param episodes: the larger budget, earlier episodes included
        """
        return replace(self, episodes=episodes, extended_from=self.stages)


TrainingConfig.__doc__ = (  # the help of the commands and the page of settings read it
    str(TrainingConfig.__doc__)
    .replace("{tasks}", ", ".join(f"``{name}`` ({task.title})" for name, task in TASKS.items()))
    .replace("{agents}", ", ".join(f"``{algo}``" for algo in AGENTS))
    .replace("{optimisers}", ", ".join(f"``{algo}``" for algo in OPTIMISERS))
)
