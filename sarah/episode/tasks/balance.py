"""The Second Training: recover from a push. V1 to V4 are learned, on given P1 to P5."""

from __future__ import annotations

from dataclasses import dataclass

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import BALANCE_PARAMETERS
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.push import DrawnPush, Push, draw_push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks.stepping import STEPPING
from sarah.episode.tasks.task import ControllerParameters, Task
from sarah.errors import ConfigurationError

TRAINED_STEPPING = (0.41, 0.52, 0.62, 1.17, 1.37)
"""Default values of P1 to P5: those that NAF learned in one training, to two digits."""


@dataclass(frozen=True)
class BalanceConfig(EpisodeConfig):
    """Settings that all episodes of an experiment share when the robot is pushed.

    :param stepping: values of P1 to P5, which the agent does not choose
    :param push: ranges that each episode's push is drawn from
    """

    stepping: tuple[float, float, float, float, float] = TRAINED_STEPPING
    push: Push = Push()

    def __post_init__(self) -> None:
        """Refuse settings that cannot be simulated, and a push shorter than a control tick."""
        super().__post_init__()
        STEPPING.checked(self.stepping, "stepping")
        if self.push.duration < self.physics.control_dt:
            tick = f"a control tick, {self.physics.control_dt:g} s"
            raise ConfigurationError(f"push.duration must be at least {tick}, not {self.push.duration!r}")

    def check_for_training(self) -> None:
        """Refuse a push that begins after the end of every episode."""
        begin, limit = self.push.at_seconds, self.time_limit
        if begin[0] >= limit:
            raise ConfigurationError(
                f"episode.push.at_seconds must begin before the time_limit of {limit:g} s, not {begin!r}"
            )


def _controller_parameters(chosen: tuple[float, ...], config: BalanceConfig) -> ControllerParameters:
    return SteppingParameters(*config.stepping), BalanceParameters(*chosen)


def _draw_push(config: BalanceConfig, seed: int) -> DrawnPush:
    return draw_push(config.push, seed)


BALANCE: Task[BalanceConfig] = Task(
    name="balance",
    title="The Second Training: after a push",
    parameters=BALANCE_PARAMETERS,
    episode=BalanceConfig(),
    controller_parameters=_controller_parameters,
    baseline=(0.0, 0.0, 0.0, 0.0),
    baseline_label="baseline: V = 0, hips locked",
    neutral=(0.0, 0.0, 0.0, 0.0),
    draw_push=_draw_push,
)
"""The paper's Second Training. The box of V1 to V4 is this project's."""
