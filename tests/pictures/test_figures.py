"""Drawings: the robot, figures of it, of its dimensions, of the controller as it runs, and of a gait cycle."""

import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from itertools import combinations
from pathlib import Path
from typing import cast

import matplotlib.pyplot as plt
import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET
from matplotlib.figure import Figure
from matplotlib.image import imread
from matplotlib.transforms import Bbox
from pytest import MonkeyPatch

from sarah import ControllerConstants, EpisodeConfig, EpisodeSpec, Window, simulate
from sarah.control.constants import STANDARD_CONSTANTS as CONSTANTS
from sarah.control.pattern_generator import PatternGenerator, Phase, SteppingParameters
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.trace import Trace
from sarah.errors import ConfigurationError
from sarah.operation.settings import SHIPPED, Change
from sarah.pictures import gait_figure, session_figure
from sarah.pictures.dimension_figure import draw_dimensions
from sarah.pictures.dimension_marks import CENTRE_OF_MASS, marks
from sarah.pictures.gait_figure import draw_gait_cycle, gait_cycle
from sarah.pictures.robot_figure import draw_robot, labels_of
from sarah.pictures.session_figure import draw_session
from sarah.pictures.state_machine_figure import draw_state_machine, hip_law, phases
from sarah.robot.description import GROUPS, describe_robot
from sarah.robot.dimensions import all_dimensions, default_dimensions
from sarah.robot.reading import SensorReading, Side
from sarah.scenery.camera import STANDARD_CAMERA, Camera, View
from sarah.scenery.floor import floor
from sarah.simulation.renderer import Renderer
from sarah.simulation.terrain import Terrain, draw_ground


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
def test_robot_and_state_machine_are_drawn_in_their_own_style(tmp_path: Path) -> None:
    files = draw_robot(describe_robot(), tmp_path / "robot") + draw_state_machine(tmp_path / "machine")
    assert [file.name for file in files] == ["robot.png", "robot.pdf", "machine.png", "machine.pdf"]
    for file in files[::2]:
        shown = imread(file)
        assert shown.shape[1] == 700 and shown[..., :3].std() > 0.02
    picture = files[2]
    with plt.style.context(["dark_background", {"savefig.dpi": 30}]):
        styled, _ = draw_state_machine(tmp_path / "styled")
        assert plt.rcParams["savefig.dpi"] == 30
    assert styled.read_bytes() == picture.read_bytes()


def test_labels_point_at_the_robot_as_it_is() -> None:
    def knee(**dimensions: float) -> tuple[str, float]:
        (label,) = (one for one in labels_of(describe_robot(dimensions)) if one.text.startswith("leg length"))
        return label.text, label.point[2]

    (text, height), (other_text, other_height) = knee(), knee(thigh_length=0.5, leg_retract_limit=0.2)
    assert "+120 mm" in text and "+200 mm" in other_text
    assert abs(height - other_height) < 0.06  # the knee stands as high, the hips higher


def traced(seconds: float) -> Trace:
    spec = EpisodeSpec(TRAINED_STEPPING, 0, config=EpisodeConfig(time_limit=seconds))
    return cast(Trace, simulate(spec, record_trace=True).trace)


def test_gait_cycle_is_one_step_with_each_leg(monkeypatch: MonkeyPatch) -> None:
    trace, drawn = traced(4.0), list[Figure]()
    rows = gait_cycle(trace)
    assert 0.3 < trace.time[rows][-1] - trace.time[rows][0] < 1.2
    stance = trace.stance[rows]
    assert (np.diff(stance) != 0).sum() == 2 and stance[0] == stance[-1] == 1
    with pytest.raises(ConfigurationError, match="completes no cycle"):
        gait_cycle(traced(1.3))
    monkeypatch.setattr(gait_figure, "save", lambda figure, _: drawn.append(figure))
    for factor in (0.1, 1.0):  # the axis of loads goes with the weight
        loads = replace(trace, pressures=factor * trace.pressures)
        draw_gait_cycle(loads, SteppingParameters(*TRAINED_STEPPING), Path("cycle"))
    light, usual = (figure.axes[2].get_ylim()[1] for figure in drawn)
    assert 600.0 < usual < 800.0 and light == pytest.approx(0.1 * usual)


def test_words_of_changes_do_not_overlap(monkeypatch: MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(session_figure, "save", lambda figure, _: drawn.append(figure))
    window = Window(0, 0.0, 60.0, 3, SHIPPED, 0.8, 0.8, False, ())
    windows = [replace(window, index=index, begin=60.0 * index) for index in range(3)]
    settings = {"terrain": {"slope_degrees": 4.0, "direction_degrees": 90.0}}
    draw_session(windows, [Change(minute, settings) for minute in (1.0, 1.1, 2.9)], Path("session"))
    (figure,) = drawn
    figure.canvas.draw()
    legend = figure.axes[0].get_legend()
    assert legend is not None
    assert "fall" not in [words.get_text() for words in legend.get_texts()]
    boxes = [words.get_window_extent() for words in (*figure.axes[0].texts, legend)]
    assert len(boxes) == 4
    assert not any(one.overlaps(other) for one, other in combinations(boxes, 2))
    assert all(figure.bbox.x0 <= box.x0 and box.x1 <= figure.bbox.x1 for box in boxes)


SMALL = {name: 0.12345 * value for name, value in default_dimensions().items()}
STILTS = {"thigh_length": 1.5, "shank_length": 2.5, "sole_half_width": 0.02}
DWARF = {"thigh_length": 0.05, "shank_length": 0.05, "torso_height": 0.9, "hip_drop": 0.45, "flexion_limit": 2.5}
FEET = {"forefoot_contact": 0.6, "hindfoot_contact": 0.03, "ankle_up_limit": 1.4, "hinge_height": 0.05}
ROBOTS: list[dict[str, float]] = [{}, SMALL, STILTS, DWARF, FEET]


@pytest.mark.parametrize("changed", ROBOTS)
def test_every_dimension_has_a_mark_as_long_as_it_says(changed: dict[str, float]) -> None:
    dimensions = all_dimensions(changed)
    shown = [mark for panel in marks(dimensions, np.zeros(3)).values() for mark in panel]
    assert sorted(mark.name for mark in shown) == sorted([*dimensions, CENTRE_OF_MASS])
    for mark in (mark for mark in shown if len(mark.points) == 2):
        along = 2 if mark.beside in ("left", "right") else slice(None, 2)
        length = np.linalg.norm(np.diff(mark.points, axis=0)[0, along])
        assert length == pytest.approx(dimensions[mark.name]), mark.name


@pytest.mark.parametrize("changed", ROBOTS)
def test_names_are_readable_whatever_the_proportions(changed: dict[str, float], monkeypatch: MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(Figure, "savefig", lambda figure, *_, **__: drawn.append(figure))
    dimensions = all_dimensions(changed)
    draw_dimensions(describe_robot(changed), dimensions, Path("robot.png"))
    texts = [text for axis in drawn[0].axes for text in axis.texts if text.get_text()]
    seen = [(text.get_text(), str(text.get_fontweight()), text.get_window_extent()) for text in texts]
    inner = [(text, box.shrunk(0.98, 0.9)) for text, _, box in seen]
    assert [(one, other) for (one, a), (other, b) in combinations(inner, 2) if a.overlaps(b)] == []
    edge = drawn[0].bbox
    assert [text for text, _, box in seen if Bbox.union([box, edge]).bounds != edge.bounds] == []
    different = dict(dimensions.items() - default_dimensions().items())
    assert {text.splitlines()[0] for text, weight, _ in seen if weight == "bold"} == different.keys()


UPRIGHT = (0.0, 0.0, 0.0, 1.0)
SIZE = (320, 240)


def test_links_are_seen_without_files_in_colours_of_their_groups() -> None:
    root = ElementTree.fromstring(describe_robot().urdf)
    assert all(link.findall("visual") for link in root.findall("link"))
    assert {shape.tag for shape in root.iterfind(".//visual/geometry/*")} <= {"box", "cylinder", "sphere"}
    links = {link.get("name"): link.findall("visual/material") for link in root.findall("link")}
    colours = {name: {material.get("name") for material in materials} for name, materials in links.items()}
    for colour, group in (("top", "top"), ("left", "left leg"), ("right", "right leg")):
        assert [name for name, links in GROUPS.items() if any(colour in colours[link] for link in links)] == [group]


@NEEDS_PYBULLET
def test_camera_stands_still_when_the_robot_drifts() -> None:
    robot, middles = describe_robot(), []
    renderer, joints = Renderer(robot), dict.fromkeys(robot.limits, 0.0)
    for x in (0.0, 0.1):
        picture = renderer.draw((x, 0.0, robot.standing_height), UPRIGHT, joints, *SIZE)
        not_floor = np.abs(picture.astype(int) - floor(*SIZE, STANDARD_CAMERA)).sum(axis=-1) > 60
        middles.append(np.nonzero(not_floor)[1].mean())
    moved = np.diff(View(*SIZE, STANDARD_CAMERA).pixels(np.array([(0.0, 0.0, 0.5), (0.1, 0.0, 0.5)]))[:, 0])[0]
    assert middles[1] - middles[0] == pytest.approx(moved, rel=0.1)


@NEEDS_PYBULLET
def test_a_lifted_foot_is_seen_and_a_robot_outside_is_not() -> None:
    robot = describe_robot()
    renderer, height, joints = Renderer(robot), robot.standing_height, dict.fromkeys(robot.limits, 0.0)
    standing, lifted = (
        renderer.draw((0.0, 0.0, height), UPRIGHT, joints | {"left_leg_length": length}, *SIZE)
        for length in (0.0, 0.03)
    )
    changed = np.abs(standing.astype(int) - lifted).sum(axis=-1) > 90
    columns = np.nonzero(changed)[1]
    assert changed.sum() > 200 and columns.min() > SIZE[0] / 2  # its left leg is on the right of the picture
    camera = Camera(yaw=180.0)
    assert (renderer.draw((5.0, 0.0, height), UPRIGHT, {}, *SIZE, camera) == floor(*SIZE, camera)).all()


@pytest.mark.parametrize("uphill", [0.0, 90.0, 215.0])
def test_gravity_points_down_in_the_picture_of_a_slope(uphill: float) -> None:
    ground = draw_ground(Terrain((15.0, 15.0), (uphill, uphill)), 0)
    camera = STANDARD_CAMERA._replace(ground=ground)
    middle = np.array((0.0, 0.0, camera.height))
    points = np.array((middle, middle + 0.01 * np.array(ground.gravity)))
    (x, y), (x_below, y_below) = View(*SIZE, camera).pixels(points)
    assert (x, y) == pytest.approx((SIZE[0] / 2, SIZE[1] / 2))
    assert x_below == pytest.approx(x) and y_below > y + 5.0


def test_floor_of_a_slope_rises_uphill() -> None:
    camera = Camera(yaw=180.0, ground=draw_ground(Terrain((15.0, 15.0), (0.0, 0.0)), 0))
    (x_right, y_right), (x_left, y_left) = View(*SIZE, camera).pixels(np.array(((0.5, 0.0, 0.0), (-0.5, 0.0, 0.0))))
    assert x_right < x_left and y_right < y_left
