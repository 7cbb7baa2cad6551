"""The First Training: step fast and stay in place. P1 to P5 are learned, with the hips locked."""

from __future__ import annotations

from sarah.control.parameters import PAPER_STEPPING, STEPPING_PARAMETERS
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks.task import ControllerParameters, Task


def _controller_parameters(chosen: tuple[float, ...], config: EpisodeConfig) -> ControllerParameters:
    return SteppingParameters(*chosen), None


STEPPING = Task(
    name="stepping",
    title="The First Training: stepping in place",
    parameters=STEPPING_PARAMETERS,
    episode=EpisodeConfig(),
    controller_parameters=_controller_parameters,
    baseline=PAPER_STEPPING,
    baseline_label="baseline: the paper's parameters, simulated here",
)
"""The paper's First Training."""
