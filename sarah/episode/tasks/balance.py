"""The Second Training: recover from a push. V1 to V4 are learned, on given P1 to P5."""

from __future__ import annotations

from dataclasses import dataclass

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import BALANCE_PARAMETERS, STEPPING_PARAMETERS
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.push import PushedConfig
from sarah.episode.shipped import shipped_parameters
from sarah.episode.tasks.stepping import STEPPING
from sarah.episode.tasks.task import ControllerParameters, Task

TRAINED_STEPPING: tuple[float, float, float, float, float] = shipped_parameters("stepping", STEPPING_PARAMETERS)
"""Default values of P1 to P5: those that the package ships as ``stepping``."""


@dataclass(frozen=True)
class BalanceConfig(PushedConfig):
    """Settings that all episodes of an experiment share when V1 to V4 are learned.

    :param stepping: values of P1 to P5, which the agent does not choose
    """

    stepping: tuple[float, float, float, float, float] = TRAINED_STEPPING

    def __post_init__(self) -> None:
        """Refuse settings that cannot be simulated, and P1 to P5 out of their box."""
        super().__post_init__()
        object.__setattr__(self, "stepping", STEPPING.box.checked(self.stepping, "stepping"))


def _controller_parameters(chosen: tuple[float, ...], config: BalanceConfig) -> ControllerParameters:
    return SteppingParameters(*config.stepping), BalanceParameters(*chosen)


BALANCE: Task[BalanceConfig] = Task(
    name="balance",
    title="The Second Training: after a push",
    parameters=BALANCE_PARAMETERS,
    episode=BalanceConfig(),
    controller_parameters=_controller_parameters,
    baseline=(0.0, 0.0, 0.0, 0.0),
    baseline_label="baseline: V = 0, hips locked",
    neutral=(0.0, 0.0, 0.0, 0.0),
)
"""The paper's Second Training. The box of V1 to V4 is this project's."""
