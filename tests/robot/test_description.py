"""The robot: what the xacro gives, and what is refused before any physics engine sees it."""

import xml.etree.ElementTree as ElementTree

import pytest

from sarah.errors import DescriptionError
from sarah.robot.description import ANKLE_JOINTS, GROUPS, JOINT_AXES, JOINT_TYPES, describe_robot, model_of
from sarah.robot.dimensions import default_dimensions, known_dimensions
from sarah.robot.reading import ACTUATED_JOINTS
from sarah.robot.scale import POWERS


@pytest.fixture
def urdf() -> str:
    return describe_robot().urdf


def find(root: ElementTree.Element, kind: str, name: str) -> ElementTree.Element:
    (element,) = (element for element in root.findall(kind) if element.get("name") == name)
    return element


def test_robot_has_six_actuated_and_four_passive_joints() -> None:
    robot = describe_robot()
    assert set(robot.limits) == {*ACTUATED_JOINTS, *ANKLE_JOINTS}
    assert len(ACTUATED_JOINTS) == 6 and len(ANKLE_JOINTS) == 4
    assert all(robot.efforts[joint] > 0 for joint in ACTUATED_JOINTS)
    assert all(robot.efforts[joint] == 0 for joint in ANKLE_JOINTS)


def test_robot_weighs_30_kg_in_three_groups_of_10(urdf: str) -> None:
    root = ElementTree.fromstring(urdf)
    masses = {link.get("name"): float(link.find("inertial/mass").get("value")) for link in root.findall("link")}  # type: ignore[union-attr,arg-type]
    for links in GROUPS.values():
        assert sum(masses[link] for link in links) == pytest.approx(10.0)
    assert sum(masses.values()) == pytest.approx(30.0)


def test_robot_stands_as_high_as_its_parts() -> None:
    dimensions = default_dimensions()
    parts = ("hip_drop", "thigh_length", "shank_length", "hinge_height")
    assert describe_robot().standing_height == pytest.approx(sum(dimensions[part] for part in parts))


def test_urdf_is_mirrored_between_the_legs(urdf: str) -> None:
    root = ElementTree.fromstring(urdf)
    for link in ("hip", "thigh", "shank", "forefoot", "hindfoot"):
        left, right = (find(root, "link", f"{side}_{link}") for side in ("left", "right"))
        assert ElementTree.tostring(left).strip().replace(b"left", b"right") == ElementTree.tostring(right).strip()
    left, right = (find(root, "joint", f"{side}_hip_abduction").find("origin") for side in ("left", "right"))
    x_left, x_right = (float(origin.get("xyz").split()[0]) for origin in (left, right))  # type: ignore[union-attr]
    assert x_left == -x_right < 0


def test_urdf_does_not_say_where_it_was_made(urdf: str) -> None:
    assert "xacro" not in urdf


def test_every_dimension_has_a_unit_and_a_meaning_and_a_range_around_its_default() -> None:
    for name, known in known_dimensions().items():
        assert known.unit in POWERS and len(known.meaning) > 10, name
        assert known.low < known.default < known.high, name


@pytest.mark.parametrize("name", list(default_dimensions()))
def test_every_dimension_reaches_the_urdf(name: str) -> None:
    assert describe_robot({name: default_dimensions()[name] * 1.01}).urdf != describe_robot().urdf


@pytest.mark.parametrize(
    ("dimensions", "message"),
    [
        ({"tigh_length": 0.3}, "unknown robot dimension 'tigh_length', did you mean 'thigh_length'"),
        ({"thigh_length": "long"}, "'thigh_length' must be a number between 0.033 and 3.3 m, not 'long'"),
        ({"thigh_length": True}, "'thigh_length' must be a number between 0.033 and 3.3 m, not True"),
        ({"thigh_length": float("nan")}, "'thigh_length' must be a number between 0.033 and 3.3 m, not nan"),
        ({"thigh_length": -0.3}, "'thigh_length' must be a number between 0.033 and 3.3 m, not -0.3"),
        ({"hinge_height": 0.005}, r"'hinge_height' must be at least 0\.015 m, .* plate_thickness 0\.01, not 0\.005: "),
        (
            {"hip_offset": 0.04, "contact_radius": 0.01},
            r"'hip_offset' must be at least 0\.06 m, .* sole_half_width 0\.05 \+ contact_radius 0\.01, not 0\.04: ",
        ),
    ],
)
def test_bad_dimensions_are_refused_by_name(dimensions: dict[str, float], message: str) -> None:
    with pytest.raises(DescriptionError, match=message) as caught:
        describe_robot(dimensions)
    assert "\n" not in str(caught.value)


def test_the_joints_turn_and_slide_as_the_package_says(urdf: str) -> None:
    joints = model_of(urdf).joint_map
    assert {name: joint.type for name, joint in joints.items()} == JOINT_TYPES
    assert {name: tuple(joint.axis) for name, joint in joints.items()} == JOINT_AXES


def test_an_invalid_urdf_is_refused(urdf: str) -> None:
    root = ElementTree.fromstring(urdf)
    joint = find(root, "joint", "left_leg_length")
    joint.remove(joint.find("limit"))  # type: ignore[arg-type]
    with pytest.raises(DescriptionError, match=r"^yourdfpy finds the URDF invalid: .*limit") as caught:
        model_of(ElementTree.tostring(root, encoding="unicode"))
    assert "\n" not in str(caught.value)
