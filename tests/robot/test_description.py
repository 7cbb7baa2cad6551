"""The robot: what the xacro gives, and what is refused before any physics engine sees it."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable

import pytest

from sarah.errors import DescriptionError
from sarah.robot.description import ANKLE_JOINTS, GROUPS, check_urdf, describe_robot, model_of
from sarah.robot.dimensions import default_dimensions, known_dimensions
from sarah.robot.links_and_joints import inertia_of, links_and_joints, place_of
from sarah.robot.reading import ACTUATED_JOINTS
from sarah.robot.scale import POWERS


@pytest.fixture
def urdf() -> str:
    return describe_robot().urdf


def changed(urdf: str, change: Callable[[ElementTree.Element], None]) -> str:
    root = ElementTree.fromstring(urdf)
    change(root)
    return ElementTree.tostring(root, encoding="unicode")


def find(root: ElementTree.Element, kind: str, name: str) -> ElementTree.Element:
    (element,) = (element for element in root.findall(kind) if element.get("name") == name)
    return element


def test_robot_has_six_actuated_and_four_passive_joints() -> None:
    robot = describe_robot()
    assert set(robot.limits) == {*ACTUATED_JOINTS, *ANKLE_JOINTS}
    assert len(ACTUATED_JOINTS) == 6 and len(ANKLE_JOINTS) == 4
    assert all(robot.efforts[joint] > 0 for joint in ACTUATED_JOINTS)
    assert all(robot.efforts[joint] == 0 for joint in ANKLE_JOINTS)


def test_yourdfpy_finds_the_default_robot_valid(urdf: str) -> None:
    assert check_urdf(urdf) == describe_robot()


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
        ({"foot_length": 0.3}, "unknown robot dimension 'foot_length', did you mean 'forefoot_contact'"),
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


def second_root(root: ElementTree.Element) -> None:
    ElementTree.SubElement(root, "link", name="stray")


def duplicate_joint(root: ElementTree.Element) -> None:
    root.append(find(root, "joint", "left_hip_flexion"))


def duplicate_link(root: ElementTree.Element) -> None:
    root.append(find(root, "link", "left_hip"))


def loop(root: ElementTree.Element) -> None:
    find(root, "joint", "left_hip_abduction").find("parent").set("link", "left_shank")  # type: ignore[union-attr]


def missing_parent(root: ElementTree.Element) -> None:
    find(root, "joint", "left_hip_flexion").find("parent").set("link", "nowhere")  # type: ignore[union-attr]


def two_parents(root: ElementTree.Element) -> None:
    find(root, "joint", "left_hip_flexion").find("child").set("link", "left_shank")  # type: ignore[union-attr]


def negative_mass(root: ElementTree.Element) -> None:
    find(root, "link", "left_hip").find("inertial/mass").set("value", "-1")  # type: ignore[union-attr]


def flat_inertia(root: ElementTree.Element) -> None:
    find(root, "link", "left_hip").find("inertial/inertia").set("ixx", "0")  # type: ignore[union-attr]


def no_inertial(root: ElementTree.Element) -> None:
    link = find(root, "link", "left_hip")
    link.remove(link.find("inertial"))  # type: ignore[arg-type]


def wrong_kind(root: ElementTree.Element) -> None:
    find(root, "joint", "left_leg_length").set("type", "revolute")


def renamed_joint(root: ElementTree.Element) -> None:
    find(root, "joint", "left_leg_length").set("name", "left_knee")


def no_limit(root: ElementTree.Element) -> None:
    joint = find(root, "joint", "left_leg_length")
    joint.remove(joint.find("limit"))  # type: ignore[arg-type]


def flipped_axis(root: ElementTree.Element) -> None:
    find(root, "joint", "left_leg_length").find("axis").set("xyz", "0 0 -1")  # type: ignore[union-attr]


def turned_frame(root: ElementTree.Element) -> None:
    find(root, "joint", "left_leg_length").find("origin").set("rpy", "0 0 1.5")  # type: ignore[union-attr]


def powerless(root: ElementTree.Element) -> None:
    find(root, "joint", "left_leg_length").find("limit").set("effort", "0")  # type: ignore[union-attr]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (second_root, "one root link, not 2"),
        (duplicate_joint, "more than one joint named 'left_hip_flexion'"),
        (duplicate_link, "more than one link named 'left_hip'"),
        (loop, "loop"),
        (missing_parent, "'left_hip_flexion' names a link 'nowhere'"),
        (two_parents, "'left_shank' has more than one parent"),
        (negative_mass, "'left_hip' must have a positive mass, not -1"),
        (flat_inertia, "'left_hip' must have a positive definite inertia"),
        (no_inertial, "'left_hip' has no mass or inertia"),
        (wrong_kind, "'left_leg_length' must be prismatic, not revolute"),
        (renamed_joint, "no joint 'left_leg_length'"),
        (no_limit, "yourdfpy finds the URDF invalid: .*limit"),
        (flipped_axis, "'left_leg_length' must turn about"),
        (turned_frame, "'left_leg_length' must turn about"),
        (powerless, "'left_leg_length' must have a positive effort limit"),
    ],
)
def test_broken_urdfs_are_refused(urdf: str, change: Callable[[ElementTree.Element], None], message: str) -> None:
    with pytest.raises(DescriptionError, match=message) as caught:
        check_urdf(changed(urdf, change))
    assert "\n" not in str(caught.value)


def test_text_that_is_not_xml_is_refused() -> None:
    with pytest.raises(DescriptionError, match="not well-formed"):
        check_urdf("<robot>")
