"""The robot, its push and the words are within the picture, whatever the robot's dimensions."""

import math
from collections.abc import Iterator
from contextlib import closing
from dataclasses import replace
from itertools import product
from typing import Any

import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET, purple, turned

from sarah.episode.trace import Trace
from sarah.pictures.overlay import arrow
from sarah.pictures.video import FEET_HEIGHT, FEET_WIDTH, HEIGHT, TEXT_WIDTH, WIDTH, cameras, frames
from sarah.robot.description import RobotDescription, describe_robot
from sarah.robot.reading import Vector
from sarah.scenery.camera import STANDARD_CAMERA, View
from sarah.scenery.floor import floor
from sarah.simulation.renderer import Renderer

pytestmark = NEEDS_PYBULLET

LENGTHS = {"torso_height": 0.3, "torso_width": 0.36, "thigh_length": 0.33, "shank_length": 0.31, "hip_offset": 0.13}
DIMENSIONS = [
    *({}, {"thigh_length": 3.3}, {"torso_width": 3.59}, {"hip_offset": 1.3}),
    {"forefoot_contact": 1.4, "sole_half_width": 0.5, "hip_offset": 0.6},
    {name: 9.9 * value for name, value in LENGTHS.items()},
    {name: 0.11 * value for name, value in LENGTHS.items()} | {"sole_half_width": 0.006, "contact_radius": 0.008},
]
DRIFTS = [(0.0, 0.0), (0.25, 0.0), (-0.25, 0.0), (0.0, 0.25), (0.0, -0.25)]
FALLS = [(math.pi / 2, 0.0), (-math.pi / 2, 0.0), (0.0, math.pi / 2), (0.0, -math.pi / 2)]
SIZE = (320, 180)


def poses(robot: RobotDescription) -> Iterator[tuple[Vector, tuple[float, float, float, float]]]:
    for x, y in DRIFTS:
        yield (x, y, robot.standing_height), (0.0, 0.0, 0.0, 1.0)
    for roll, pitch in FALLS:
        yield (0.2, 0.1, 0.2 * robot.scale.length), turned(roll, pitch)


def still(robot: RobotDescription, force: np.ndarray, drift: tuple[float, float] = (0.0, 0.0)) -> Trace:
    """Trace of a robot that stands still while it is pushed."""
    ticks = 4
    widths = dict.fromkeys(("acceleration", "angular_rate"), 3) | dict.fromkeys(("joints", "targets"), 6)
    rows: dict[str, Any] = {
        name: np.zeros((ticks, width)) for name, width in {**widths, "ankles": 4, "pressures": 4}.items()
    }
    rows |= {name: np.zeros(ticks) for name in ("rate", "tilt", "stable_x", "score", "steps_per_second")}
    rows |= {"time": np.arange(ticks) / 10, "stance": np.ones(ticks), "push": np.tile(force, (ticks, 1))}
    rows["position"] = np.tile((*drift, robot.standing_height), (ticks, 1))
    rows["orientation"] = np.tile((0.0, 0.0, 0.0, 1.0), (ticks, 1))
    return Trace(phase=np.full(ticks, "shift"), **rows)


def pushes(newtons: float, count: int) -> Iterator[np.ndarray]:
    for angle in np.linspace(0.0, 2 * math.pi, count, endpoint=False):
        yield newtons * np.array((math.cos(angle), math.sin(angle), 0.0))


def is_within(pixels: np.ndarray, width: int, height: int) -> bool:
    return bool((pixels > 0.0).all() and (pixels < (width, height)).all())


@pytest.mark.parametrize("dimensions", DIMENSIONS, ids=str)
def test_the_whole_robot_and_every_push_are_in_the_picture(dimensions: dict[str, float]) -> None:
    robot = describe_robot(dimensions)
    with closing(Renderer(robot)) as renderer:
        for position, orientation in poses(robot):
            seen = renderer.seen(position, orientation, dict.fromkeys(robot.limits, 0.0))
            camera = renderer.camera.seeing(seen, *SIZE)
            pixels = View(*SIZE, camera).pixels(seen)
            assert is_within(pixels, *SIZE)
            picture = renderer.draw(position, orientation, {}, *SIZE)
            rows, columns = np.nonzero(np.abs(picture.astype(int) - floor(*SIZE, camera)).sum(axis=-1) > 60)
            assert len(rows) > 50
            # What is drawn is between the points that the camera sees: nothing is cut off where they end.
            assert columns.min() >= pixels[:, 0].min() - 1.5 and columns.max() <= pixels[:, 0].max() + 1.5
            assert rows.min() >= pixels[:, 1].min() - 1.5 and rows.max() <= pixels[:, 1].max() + 1.5
        for drift, force in product(DRIFTS, pushes(150.0, 8)):
            trace = still(robot, force, drift)
            camera, feet = cameras(trace, robot, renderer)
            pose = tuple(trace.position[0]), (0.0, 0.0, 0.0, 1.0), dict.fromkeys(robot.limits, 0.0)
            ends = arrow(trace.position[0], force, robot.scale)
            far, close = View(WIDTH, HEIGHT, camera), View(FEET_WIDTH, FEET_HEIGHT, feet)
            assert is_within(far.pixels(np.concatenate((renderer.seen(*pose), ends))), WIDTH, HEIGHT)
            assert is_within(close.pixels(renderer.seen(*pose, only_feet=True)), FEET_WIDTH, FEET_HEIGHT)


def test_a_standing_robot_of_standard_size_is_seen_as_ever() -> None:
    robot = describe_robot()
    with closing(Renderer(robot)) as renderer:
        for force in pushes(100.0, 12):
            assert cameras(still(robot, force), robot, renderer)[0] == STANDARD_CAMERA


@pytest.mark.parametrize("dimensions", DIMENSIONS[::3], ids=str)
def test_no_arrow_and_no_label_touches_the_edge(dimensions: dict[str, float]) -> None:
    robot = describe_robot(dimensions)
    for force in pushes(150.0, 4):
        (picture,) = frames(still(robot, force, (-0.25, 0.25)), robot, (0.0,))
        marks = purple(np.asarray(picture))
        assert marks.sum() > 1000
        assert not (marks[:5].any() or marks[-5:].any() or marks[:, :5].any() or marks[:, -5:].any())


NUMBERS = ", ".join(f"P{index} = {index / 7:.2f}" for index in range(60))
CAPTIONS = [NUMBERS, "one\ntwo\nthree", "a_task_with_a_name_" + 20 * "without_end_" + ": P1 0.40"]


@pytest.mark.parametrize("caption", CAPTIONS)
def test_long_captions_stay_clear_of_edges_robot_and_phases(caption: str) -> None:
    robot = describe_robot()
    trace = still(robot, np.zeros(3))
    (with_caption,), (without,) = (frames(trace, robot, (0.0,), text) for text in (caption, ""))
    rows, columns = np.nonzero((np.asarray(with_caption) != np.asarray(without)).any(axis=-1))
    assert rows.min() > 0.72 * HEIGHT and rows.max() < HEIGHT - 5
    assert columns.min() > 5 and columns.max() < TEXT_WIDTH


def test_a_robot_that_fell_while_it_stood_is_drawn() -> None:
    robot = describe_robot()
    trace = replace(still(robot, np.zeros(3)), phase=np.full(4, "stand"))
    (picture,) = frames(trace, robot, (0.2,))
    assert picture.size == (WIDTH, HEIGHT)
