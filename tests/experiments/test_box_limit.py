"""The box that is wider than the paper's."""

from typing import Any

import pytest

from experiments.box_limit import ending_of_wide_box
from sarah.control.pattern_generator import Phase
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tick import Tick
from sarah.robot.reading import STANDING, Side
from sarah.simulation.simulator import TorsoState


@pytest.mark.parametrize(("x", "expected"), [(0.49, None), (0.51, "left_box"), (-0.51, "left_box")])
def test_the_wide_box_reaches_half_a_metre(x: float, expected: str | None) -> None:
    nobody: Any = None  # the endings do not ask the simulator
    torso = TorsoState((1.0 + x, 0.0, 0.84), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    tick = Tick(6.0, (1.0, 0.0, 0.84), torso, 9, 3.0, Phase.SHIFT, Side.LEFT, STANDING, STANDING, nobody)
    assert ending_of_wide_box(tick, EpisodeConfig()) == expected
