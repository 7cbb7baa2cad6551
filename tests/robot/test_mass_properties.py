"""Masses, centre of mass and inertia of the standing robot."""

import numpy as np
import pytest
from laboratory import need

from sarah.robot.description import describe_robot
from sarah.robot.standing import MassProperties, links_of, together

NOTHING = np.zeros((3, 3))


def test_two_points_have_the_inertia_of_a_dumbbell() -> None:
    pair = together([MassProperties(1.0, np.array((x, 0.0, 0.5)), NOTHING) for x in (-1.0, 1.0)])
    assert pair.mass == 2.0 and pair.centre == pytest.approx((0.0, 0.0, 0.5))
    assert np.diag(pair.inertia) == pytest.approx((0.0, 2.0, 2.0))


def test_the_default_robot_stands_over_its_feet() -> None:
    robot = describe_robot()
    links = links_of(robot)
    whole = together(links.values())
    assert {name: link.mass for name, link in links.items()} == robot.masses
    assert whole.mass == pytest.approx(30.0) and whole.centre[0] == pytest.approx(0.0)
    soles = np.array(robot.standing_soles)
    assert (soles.min(axis=0)[:2] < whole.centre[:2]).all() and (whole.centre[:2] < soles.max(axis=0)[:2]).all()


@pytest.mark.parametrize("dimensions", [{"thigh_length": 0.2, "forefoot_contact": 0.2, "hip_offset": 0.2}])
def test_an_engine_finds_the_same(dimensions: dict[str, float]) -> None:
    need("mujoco")
    import mujoco

    robot = describe_robot(dimensions)
    model = mujoco.MjModel.from_xml_string(robot.urdf)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    legs = together(link for name, link in links_of(robot).items() if name != "torso")
    assert legs.mass == pytest.approx(model.body_subtreemass[0])
    assert legs.centre == pytest.approx(data.subtree_com[0] + (0.0, 0.0, robot.standing_height))
