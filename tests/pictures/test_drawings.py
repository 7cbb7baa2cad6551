"""What the robot looks like, and where it is in a picture."""

import xml.etree.ElementTree as ElementTree

import numpy as np
import pytest
from laboratory import need

from sarah.robot.description import GROUPS, RobotDescription, describe_robot
from sarah.scenery.camera import STANDARD_CAMERA, Camera, View
from sarah.scenery.floor import floor
from sarah.simulation.renderer import Renderer
from sarah.simulation.terrain import Terrain, draw_ground

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
SIZE = (320, 240)


@pytest.fixture(scope="module")
def robot() -> RobotDescription:
    return describe_robot()


@pytest.fixture(scope="module")
def renderer(robot: RobotDescription) -> Renderer:
    need("pybullet")
    return Renderer(robot)


def drawn(renderer: Renderer, robot: RobotDescription, x: float = 0.0, **joints: float) -> np.ndarray:
    every = dict.fromkeys(robot.limits, 0.0) | joints
    return renderer.draw((x, 0.0, robot.standing_height), UPRIGHT, every, *SIZE)


def not_floor(picture: np.ndarray) -> np.ndarray:
    return np.abs(picture.astype(int) - floor(*SIZE, STANDARD_CAMERA)).sum(axis=-1) > 60


def test_links_are_seen_without_files_in_colours_of_their_groups(robot: RobotDescription) -> None:
    root = ElementTree.fromstring(robot.urdf)
    assert all(link.findall("visual") for link in root.findall("link"))
    assert {shape.tag for shape in root.iterfind(".//visual/geometry/*")} <= {"box", "cylinder", "sphere"}
    colours = {
        link.get("name"): {material.get("name") for material in link.findall("visual/material")}
        for link in root.findall("link")
    }
    for colour, group in (("top", "top"), ("left", "left leg"), ("right", "right leg")):
        assert [name for name, links in GROUPS.items() if any(colour in colours[link] for link in links)] == [group]


def test_robot_is_drawn_where_the_camera_sees_it(renderer: Renderer, robot: RobotDescription) -> None:
    rows, columns = np.nonzero(not_floor(drawn(renderer, robot)))
    head = np.array([(x, y, robot.standing_height + 0.15) for x in (-0.18, 0.18) for y in (-0.1, 0.1)])
    pixels = View(*SIZE, STANDARD_CAMERA).pixels(head)
    assert rows.min() == pytest.approx(pixels[:, 1].min(), abs=1.5)
    assert columns[rows < rows.min() + 40].min() == pytest.approx(pixels[:, 0].min(), abs=1.5)
    assert columns[rows < rows.min() + 40].max() == pytest.approx(pixels[:, 0].max(), abs=1.5)


def test_camera_stands_still_when_the_robot_drifts(renderer: Renderer, robot: RobotDescription) -> None:
    here, there = (np.nonzero(not_floor(drawn(renderer, robot, x)))[1].mean() for x in (0.0, 0.1))
    moved = np.diff(View(*SIZE, STANDARD_CAMERA).pixels(np.array([(0.0, 0.0, 0.5), (0.1, 0.0, 0.5)]))[:, 0])[0]
    assert there - here == pytest.approx(moved, rel=0.1)


def test_lifted_foot_is_seen_to_be_off_the_floor(renderer: Renderer, robot: RobotDescription) -> None:
    standing, lifted = drawn(renderer, robot), drawn(renderer, robot, left_leg_length=0.03)
    changed = np.abs(standing.astype(int) - lifted).sum(axis=-1) > 90
    columns = np.nonzero(changed)[1]
    assert changed.sum() > 200 and columns.min() > SIZE[0] / 2  # its left leg is on the right of the picture


def test_robot_out_of_the_picture_leaves_the_floor_alone(robot: RobotDescription, renderer: Renderer) -> None:
    picture = renderer.draw((5.0, 0.0, robot.standing_height), UPRIGHT, {}, *SIZE, Camera(yaw=180.0))
    assert (picture == floor(*SIZE, Camera(yaw=180.0))).all()


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
