"""Figures of the robot, of the controller as it runs, and of a gait cycle."""

import dataclasses
import itertools
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET
from matplotlib.figure import Figure
from matplotlib.image import imread

from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import PatternGenerator, Phase, SteppingParameters
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.trace import Trace
from sarah.errors import ConfigurationError
from sarah.operation.settings import SHIPPED, Change
from sarah.operation.window import Window
from sarah.pictures import gait_figure, session_figure
from sarah.pictures.gait_figure import draw_gait_cycle, gait_cycle
from sarah.pictures.robot_figure import draw_robot, labels_of
from sarah.pictures.session_figure import draw_session
from sarah.pictures.state_machine_figure import draw_state_machine, hip_law, phases
from sarah.robot.description import RobotDescription, describe_robot
from sarah.robot.reading import SensorReading, Side


@pytest.mark.parametrize("constants", [CONSTANTS, ControllerConstants(lift_retraction=0.011, time_out_seconds=0.2)])
def test_the_state_machine_is_that_of_the_generator(constants: ControllerConstants) -> None:
    silence = SensorReading((0.0, 0.0, 9.81), (0.0,) * 3, (0.0,) * 4, (0.0,) * 6)
    generator = PatternGenerator(SteppingParameters(1.0, 1.0, 1.0, P4=0.5, P5=1.0), dt=0.001, constants=constants)
    while generator.phase is Phase.STAND:
        generator.tick(silence)
    for facts in (*phases(constants), *phases(constants)):
        ticks, swing = 0, generator.swing
        while generator.phase is facts.phase and generator.swing is swing:
            lengths = dict(zip(Side, generator.targets[4:], strict=True))
            generator.tick(silence)
            ticks += 1
        formula = facts.time_out.replace(" (", " * (").replace("P4", "0.5").replace("P5", "1.0")
        assert 0.001 * ticks == pytest.approx(eval(formula))
        assert lengths == {swing: facts.swing_length, swing.other: 0.0}
    assert f"rate > {constants.rate_scale:g} P3" in phases(constants)[0].condition


def test_the_hip_law_has_the_constants_of_the_controller() -> None:
    law = hip_law(ControllerConstants(capture_gain=9.5, spread_gain=3.0))
    assert law["flexion of an unloaded leg"] == f"\N{MINUS SIGN}9.5 V3 fall + {CONSTANTS.flexion_scale:g} V4"
    assert law["flexion of a loaded leg"] == f"{CONSTANTS.flexion_scale:g} V4"
    assert law["and outward"].startswith("3 V1 (outward lean")


@NEEDS_PYBULLET
def test_robot_and_state_machine_are_drawn(tmp_path: Path) -> None:
    files = draw_robot(describe_robot(), tmp_path / "robot") + draw_state_machine(tmp_path / "machine")
    assert {file.name for file in files} == {"robot.png", "robot.pdf", "machine.png", "machine.pdf"}
    for file in files[::2]:
        picture = imread(file)
        assert picture.shape[1] == 700 and picture[..., :3].std() > 0.02


def test_figures_do_not_follow_the_style_of_the_caller(tmp_path: Path) -> None:
    picture, _ = draw_state_machine(tmp_path / "plain")
    with plt.style.context(["dark_background", {"savefig.dpi": 30}]):
        styled, _ = draw_state_machine(tmp_path / "styled")
        assert plt.rcParams["savefig.dpi"] == 30
    assert styled.read_bytes() == picture.read_bytes()


def test_labels_point_at_the_robot_as_it_is() -> None:
    def knee(robot: RobotDescription) -> tuple[str, float]:
        (label,) = (label for label in labels_of(robot) if label.text.startswith("leg length"))
        return label.text, label.point[2]

    (text, height), (other_text, other_height) = (
        knee(describe_robot(dimensions)) for dimensions in ({}, {"thigh_length": 0.5, "leg_retract_limit": 0.2})
    )
    assert "+120 mm" in text and "+200 mm" in other_text
    assert abs(height - other_height) < 0.06  # the knee stands as high, the hips higher


@pytest.fixture(scope="module")
def trace() -> Trace:
    found = simulate(EpisodeSpec(TRAINED_STEPPING, 0, config=EpisodeConfig(time_limit=4.0)), record_trace=True).trace
    assert found is not None
    return found


def test_gait_cycle_is_one_step_with_each_leg(trace: Trace, tmp_path: Path) -> None:
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


@pytest.fixture
def figures(monkeypatch: pytest.MonkeyPatch) -> list[Figure]:
    """Figures that are drawn, in place of their files."""
    drawn: list[Figure] = []

    def save(figure: Figure, path: Path) -> list[Path]:
        drawn.append(figure)
        return []

    for module in (gait_figure, session_figure):
        monkeypatch.setattr(module, "save", save)
    return drawn


def test_the_axis_of_loads_goes_with_the_weight(trace: Trace, figures: list[Figure]) -> None:
    for factor in (0.1, 1.0, 4.0):
        loads = dataclasses.replace(trace, pressures=factor * trace.pressures)
        draw_gait_cycle(loads, SteppingParameters(*TRAINED_STEPPING), Path("cycle"))
    light, usual, heavy = (figure.axes[2].get_ylim()[1] for figure in figures)
    assert 600.0 < usual < 800.0
    assert (light, heavy) == pytest.approx((0.1 * usual, 4.0 * usual))


def test_words_of_changes_do_not_overlap(figures: list[Figure]) -> None:
    window = Window(0, 0.0, 60.0, 3, SHIPPED, 0.8, 0.8, False, ())
    windows = [dataclasses.replace(window, index=index, begin=60.0 * index) for index in range(3)]
    settings = {"terrain": {"slope_degrees": 4.0, "direction_degrees": 90.0}}
    draw_session(windows, [Change(minute, settings) for minute in (1.0, 1.1, 2.9)], Path("session"))
    (figure,) = figures
    figure.canvas.draw()
    axis = figure.axes[0]
    legend = axis.get_legend()
    assert legend is not None
    boxes = [words.get_window_extent() for words in (*axis.texts, legend)]
    assert len(boxes) == 4
    for one, other in itertools.combinations(boxes, 2):
        assert not one.overlaps(other)
    assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)
