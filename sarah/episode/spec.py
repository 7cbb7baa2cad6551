"""The specification of an episode: everything that its result depends on."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import STEPPING, Task, task_named
from sarah.errors import ConfigurationError, shortened
from sarah.number import plain
from sarah.robot.description import RobotDescription, describe_robot
from sarah.scenery.ground import Ground
from sarah.simulation.terrain import draw_ground

FIRST_TRAINING_SEED = 2**31
"""First seed that trainings draw for their episodes; no training uses a smaller one."""
FIRST_EVALUATION_SEED = 1000
"""First seed of evaluations: the summary at the end of a training has those from 0."""


@dataclass(frozen=True)
class EpisodeSpec:
    """The specification of an episode: everything that its result depends on.

    :param parameters: values of the task's parameters, in order: P1 to P5, or V1 to V4
    :param seed: seed of the conditions, the push and the sensor noise; a whole number, not negative
    :param task: task, or the name of one of this package, such as ``"stepping"``
    :param config: settings that all episodes of an experiment share; by default the task's own
    :raises ConfigurationError: for an unknown task, another task's settings, parameters out of their box, or an
        invalid seed
    """

    parameters: tuple[float, ...]
    seed: int
    task: Task[Any] = STEPPING
    config: EpisodeConfig = None  # type: ignore[assignment]  # the task's own

    if TYPE_CHECKING:  # arguments may be what __post_init__ converts

        def __init__(
            self,
            parameters: Sequence[float],
            seed: int,
            task: str | Task[Any] = ...,
            config: EpisodeConfig | None = ...,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Refuse invalid specifications, and convert the parameters to floats."""
        task = task_named(self.task)
        object.__setattr__(self, "task", task)
        object.__setattr__(self, "parameters", task.box.checked(self.parameters))
        object.__setattr__(
            self, "config", task.episode if self.config is None else task.checked_config(self.config, True)
        )
        object.__setattr__(self, "seed", plain(self.seed))
        if type(self.seed) is not int or self.seed < 0:
            raise ConfigurationError(f"seed must be a whole number from 0, not {shortened(self.seed)}")

    @property
    def robot(self) -> RobotDescription:
        """Robot of the episode, as designed: what its pictures show."""
        return describe_robot(self.config.dimensions)

    @property
    def ground(self) -> Ground:
        """Ground that the episode's seed draws."""
        return draw_ground(self.config.terrain, self.seed)
