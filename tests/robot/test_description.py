"""The robot: what the xacro gives, what is refused before any engine sees it, and how its mass is distributed."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable

import numpy as np
import pytest
from laboratory import need

from sarah.errors import DescriptionError
from sarah.robot.description import ANKLE_JOINTS, GROUPS, check_urdf, describe_robot, model_of
from sarah.robot.dimensions import check_dimensions, default_dimensions, known_dimensions
from sarah.robot.links_and_joints import inertia_of, links_and_joints, place_of
from sarah.robot.reading import ACTUATED_JOINTS
from sarah.robot.scale import POWERS
from sarah.robot.standing import MassProperties, links_of, together

Change = Callable[[ElementTree.Element], object]


def find(root: ElementTree.Element, kind: str, name: str) -> ElementTree.Element:
    (element,) = (element for element in root.findall(kind) if element.get("name") == name)
    return element


def test_robot_has_six_actuated_and_four_passive_joints() -> None:
    robot, dimensions = describe_robot(), default_dimensions()
    assert check_urdf(robot.urdf) == robot  # yourdfpy finds it valid
    assert set(robot.limits) == {*ACTUATED_JOINTS, *ANKLE_JOINTS}
    assert [robot.efforts[joint] > 0 for joint in ACTUATED_JOINTS] == [True] * 6
    assert [robot.efforts[joint] for joint in ANKLE_JOINTS] == [0.0] * 4
    for links in GROUPS.values():
        assert sum(robot.masses[link] for link in links) == pytest.approx(10.0)
    assert sum(robot.masses.values()) == pytest.approx(30.0)
    parts = ("hip_drop", "thigh_length", "shank_length", "hinge_height")
    assert robot.standing_height == pytest.approx(sum(dimensions[part] for part in parts))
    with pytest.raises(DescriptionError, match="not well-formed"):
        check_urdf("<robot>")


@pytest.mark.parametrize("dimensions", [{}, {"hip_drop": 0.163, "thigh_length": 0.327, "shank_length": 0.301}])
def test_links_are_to_the_last_bit_where_yourdfpy_finds_them(dimensions: dict[str, float]) -> None:
    robot = describe_robot(dimensions)
    links, joints = links_and_joints(robot.urdf)
    model = model_of(robot.urdf)
    assert list(links) == list(model.link_map)
    for name, link in model.link_map.items():
        assert (place_of(name, joints) == model.get_transform(name, "torso")[:3, 3]).all(), name
        assert robot.masses[name] == link.inertial.mass
        assert (inertia_of(links[name]) == link.inertial.inertia).all(), name


def test_urdf_is_mirrored_between_the_legs() -> None:
    urdf = describe_robot().urdf
    assert "xacro" not in urdf  # where it was made
    root = ElementTree.fromstring(urdf)
    for link in ("hip", "thigh", "shank", "forefoot", "hindfoot"):
        left, right = (find(root, "link", f"{side}_{link}") for side in ("left", "right"))
        assert ElementTree.tostring(left).strip().replace(b"left", b"right") == ElementTree.tostring(right).strip()
    origins = (find(root, "joint", f"{side}_hip_abduction").find("origin") for side in ("left", "right"))
    x_left, x_right = (float(origin.get("xyz").split()[0]) for origin in origins)  # type: ignore[union-attr]
    assert x_left == -x_right < 0


def test_every_dimension_has_unit_meaning_and_range() -> None:
    for name, known in known_dimensions().items():
        assert known.unit in POWERS and len(known.meaning) > 10, name
        assert known.low < known.default < known.high, name


@pytest.mark.parametrize("name", list(default_dimensions()))
def test_every_dimension_reaches_the_urdf(name: str) -> None:
    assert describe_robot({name: default_dimensions()[name] * 1.01}).urdf != describe_robot().urdf


def test_the_ends_of_a_dimensions_range_are_allowed() -> None:
    for name in ("thigh_length", "torso_mass"):
        known = known_dimensions()[name]
        for end in (known.low, known.high):
            assert check_dimensions({name: end}) == {name: end}


WIDTH = r"sole_half_width 0\.05 \+ contact_radius 0\.01"


@pytest.mark.parametrize(
    ("dimensions", "message"),
    [
        ({"tigh_length": 0.3}, "unknown robot dimension 'tigh_length', did you mean 'thigh_length'"),
        ({"foot_length": 0.3}, "unknown robot dimension 'foot_length', did you mean 'forefoot_contact'"),
        ({"thigh_length": "long"}, "'thigh_length' must be a number between 0.033 and 3.3 m, not 'long'"),
        ({"thigh_length": -0.3}, "'thigh_length' must be a number between 0.033 and 3.3 m, not -0.3"),
        ({"hinge_height": 0.005}, r"'hinge_height' must be at least 0\.015 m, .* plate_thickness 0\.01, not 0\.005: "),
        ({"hip_offset": 0.04, "contact_radius": 0.01}, rf"'hip_offset' must be at least 0\.06 m, .* {WIDTH}, not 0"),
    ],
)
def test_bad_dimensions_are_refused_by_name(dimensions: dict[str, float], message: str) -> None:
    with pytest.raises(DescriptionError, match=message) as caught:
        describe_robot(dimensions)
    assert "\n" not in str(caught.value)


def missing(kind: str, name: str, part: str) -> Change:
    def change(root: ElementTree.Element) -> None:
        element = find(root, kind, name)
        element.remove(next(element.iter(part)))

    return change


def with_value(kind: str, name: str, part: str, /, **values: str) -> Change:
    return lambda root: next(find(root, kind, name).iter(part)).attrib.update(values)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda root: ElementTree.SubElement(root, "link", name="stray"), "one root link, not 2"),
        (lambda root: root.append(find(root, "joint", "left_hip_flexion")), "more than one joint named 'left_hip_fl"),
        (lambda root: root.append(find(root, "link", "left_hip")), "more than one link named 'left_hip'"),
        (with_value("joint", "left_hip_abduction", "parent", link="left_shank"), "loop"),
        (with_value("joint", "left_hip_flexion", "parent", link="nowhere"), "flexion' names a link 'nowhere'"),
        (with_value("joint", "left_hip_flexion", "child", link="left_shank"), "'left_shank' has more than one parent"),
        (with_value("link", "left_hip", "mass", value="-1"), "'left_hip' must have a positive mass, not -1"),
        (with_value("link", "left_hip", "inertia", ixx="0"), "'left_hip' must have a positive definite inertia"),
        (missing("link", "left_hip", "inertial"), "'left_hip' has no mass or inertia"),
        (with_value("joint", "left_leg_length", "joint", type="revolute"), "must be prismatic, not revolute"),
        (with_value("joint", "left_leg_length", "joint", name="left_knee"), "no joint 'left_leg_length'"),
        (missing("joint", "left_leg_length", "limit"), "yourdfpy finds the URDF invalid: .*limit"),
        (with_value("joint", "left_leg_length", "axis", xyz="0 0 -1"), "'left_leg_length' must turn about"),
        (with_value("joint", "left_leg_length", "origin", rpy="0 0 1.5"), "'left_leg_length' must turn about"),
        (with_value("joint", "left_leg_length", "limit", effort="0"), "must have a positive effort limit"),
    ],
)
def test_broken_urdfs_are_refused(change: Change, message: str) -> None:
    root = ElementTree.fromstring(describe_robot().urdf)
    change(root)
    with pytest.raises(DescriptionError, match=message) as caught:
        check_urdf(ElementTree.tostring(root, encoding="unicode"))
    assert "\n" not in str(caught.value)


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
