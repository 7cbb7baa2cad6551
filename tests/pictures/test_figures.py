"""Figures of the robot, of the controller as it runs, and of a gait cycle."""

from pathlib import Path

import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET
from matplotlib.image import imread

from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import Phase, SteppingParameters
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.errors import ConfigurationError
from sarah.pictures.gait_figure import draw_gait_cycle, gait_cycle
from sarah.pictures.robot_figure import draw_robot, labels_of
from sarah.pictures.state_machine_figure import draw_state_machine, read_hip_law, read_state_machine
from sarah.robot.description import RobotDescription, describe_robot


def test_state_machine_is_read_from_the_code_that_runs() -> None:
    shift, lift, land = read_state_machine()
    assert [facts.phase for facts in (shift, lift, land)] == [Phase.SHIFT, Phase.LIFT, Phase.LAND]
    assert [facts.following for facts in (shift, lift, land)] == [Phase.LIFT, Phase.LAND, Phase.SHIFT]
    assert [facts.swaps_legs for facts in (shift, lift, land)] == [False, False, True]
    assert shift.conditions[:2] == ("tilt > P2", f"rate > {CONSTANTS.rate_scale:g} P3")
    assert (shift.swing_length, lift.swing_length) == (-CONSTANTS.shift_extension, CONSTANTS.lift_retraction)
    assert lift.time_out == f"{CONSTANTS.time_out_seconds:g} (1 + P4)"
    shift, lift, _ = read_state_machine(
        ControllerConstants(rate_scale=0.7, lift_retraction=0.011, time_out_seconds=0.2)
    )
    assert "rate > 0.7 P3" in shift.conditions and lift.swing_length == 0.011 and lift.time_out == "0.2 (1 + P4)"


def test_hip_law_is_read_from_the_code_that_runs() -> None:
    law = read_hip_law(ControllerConstants(capture_gain=9.5))
    assert law["flexion of an unloaded leg"] == f"\N{MINUS SIGN}9.5 V3 fall + {CONSTANTS.flexion_scale:g} V4"
    assert law["flexion of a loaded leg"] == f"{CONSTANTS.flexion_scale:g} V4"


@NEEDS_PYBULLET
def test_robot_and_state_machine_are_drawn(tmp_path: Path) -> None:
    files = draw_robot(describe_robot(), tmp_path / "robot") + draw_state_machine(tmp_path / "machine")
    assert {file.name for file in files} == {"robot.png", "robot.pdf", "machine.png", "machine.pdf"}
    for file in files[::2]:
        picture = imread(file)
        assert picture.shape[1] == 700 and picture[..., :3].std() > 0.02


def test_labels_point_at_the_robot_as_it_is() -> None:
    def knee(robot: RobotDescription) -> tuple[str, float]:
        (label,) = (label for label in labels_of(robot) if label.text.startswith("leg length"))
        return label.text, label.point[2]

    (text, height), (other_text, other_height) = (
        knee(describe_robot(dimensions)) for dimensions in ({}, {"thigh_length": 0.5, "leg_retract_limit": 0.2})
    )
    assert "+120 mm" in text and "+200 mm" in other_text
    assert abs(height - other_height) < 0.06  # the knee stands as high, the hips higher


def test_gait_cycle_is_one_step_with_each_leg(tmp_path: Path) -> None:
    config = EpisodeConfig(time_limit=6.0)
    trace = simulate(EpisodeSpec(TRAINED_STEPPING, 0, config=config), record_trace=True).trace
    assert trace is not None
    rows = gait_cycle(trace)
    assert 0.3 < trace.time[rows][-1] - trace.time[rows][0] < 1.2
    stance = trace.stance[rows]
    assert (np.diff(stance) != 0).sum() == 2 and stance[0] == stance[-1] == 1
    files = draw_gait_cycle(trace, SteppingParameters(*TRAINED_STEPPING), tmp_path / "cycle")
    assert [file.name for file in files] == ["cycle.png", "cycle.pdf"]


def test_robot_that_makes_no_cycle_has_none_to_draw() -> None:
    spec = EpisodeSpec(TRAINED_STEPPING, 0, config=EpisodeConfig(time_limit=1.3))
    trace = simulate(spec, record_trace=True).trace
    assert trace is not None
    with pytest.raises(ConfigurationError, match="completes no cycle"):
        gait_cycle(trace)
