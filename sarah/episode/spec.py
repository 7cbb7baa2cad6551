"""Everything that an episode's result depends on, as plain dataclasses.

Light on purpose: commands import it before anything slow.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import get_args

from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.push import LONGEST_EPISODE, Push
from sarah.episode.reward import RewardForm
from sarah.episode.tasks import STEPPING, TASKS
from sarah.errors import ConfigurationError, check_range, unknown_name
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS, Physics
from sarah.simulation.randomisation import Randomisation

FIRST_TRAINING_SEED = 2**31
"""First seed of episodes that trainings draw; smaller ones stay unseen by every training."""
TRAINED_STEPPING = (0.41, 0.52, 0.62, 1.17, 1.37)
"""P1 to P5 that the balance task keeps unless others are given: what NAF learned once, to two digits."""


@dataclass(frozen=True)
class EpisodeConfig:
    """What all episodes of an experiment share.

    :param physics: how finely to integrate
    :param engine: what integrates: ``"pybullet"``, the reference, or ``"mujoco"``
    :param randomisation: what to draw from each episode's seed
    :param dimensions: of the robot, names and values where they differ from the xacro's; by default none do
    :param time_limit: of an episode, in s; the paper's first criterion
    :param reward_form: ``"symmetric"``, or ``"printed"`` for equation 2 to the letter
    :param stepping: P1 to P5 of the balance task, which the agent does not choose there
    :param push: of the balance task
    """

    physics: Physics = PHYSICS["standard"]
    engine: Engine = "pybullet"
    randomisation: Randomisation = Randomisation()
    dimensions: Mapping[str, float] = field(default_factory=dict)
    time_limit: float = 30.0
    reward_form: RewardForm = "symmetric"
    stepping: tuple[float, float, float, float, float] = TRAINED_STEPPING
    push: Push = Push()

    def __post_init__(self) -> None:
        """Refuse what cannot be simulated."""
        if self.engine not in get_args(Engine):
            raise ConfigurationError(unknown_name("engine", self.engine, get_args(Engine)))
        check_range("time_limit", self.time_limit, STAND_SECONDS, LONGEST_EPISODE, "s")
        if self.time_limit < STAND_SECONDS + self.physics.control_dt:
            raise ConfigurationError(
                f"time_limit must be above the {STAND_SECONDS:g} s of standing, not {self.time_limit!r}"
            )
        if self.reward_form not in get_args(RewardForm):
            raise ConfigurationError(unknown_name("reward_form", self.reward_form, get_args(RewardForm)))
        STEPPING.checked(self.stepping, "stepping")
        if self.push.duration < self.physics.control_dt:
            tick = f"a control tick, {self.physics.control_dt:g} s"
            raise ConfigurationError(f"push.duration must be at least {tick}, not {self.push.duration!r}")


@dataclass(frozen=True)
class EpisodeSpec:
    """Everything that an episode's result depends on.

    :param parameters: of the task: P1 to P5, or V1 to V4
    :param seed: of the conditions and the push that are drawn and of the sensor noise; a whole number from 0
    :param task: what is trained: ``"stepping"`` or ``"balance"``
    :param config: what all episodes of an experiment share
    :raises ConfigurationError: for an unknown task, parameters out of their box, or a seed that is none
    """

    parameters: tuple[float, ...]
    seed: int
    task: str = "stepping"
    config: EpisodeConfig = EpisodeConfig()

    def __post_init__(self) -> None:
        """Refuse what has no result of its own, and take the parameters as floats."""
        if self.task not in TASKS:
            raise ConfigurationError(unknown_name("task", self.task, TASKS))
        object.__setattr__(self, "parameters", TASKS[self.task].checked(self.parameters))
        if not isinstance(self.seed, int) or isinstance(self.seed, bool) or self.seed < 0:
            raise ConfigurationError(f"seed must be a whole number from 0, not {self.seed!r}")
