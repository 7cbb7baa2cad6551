"""Links and joints of a URDF whose joints turn no frame, as the robot's: places add up."""

from __future__ import annotations

from collections.abc import Mapping
from xml.etree.ElementTree import Element, fromstring

import numpy as np


def links_and_joints(urdf: str) -> tuple[dict[str, Element], dict[str, Element]]:
    """Elements of the links by their names, and those of the joints.

    :param urdf: text of the URDF
    """
    root = fromstring(urdf)
    links, joints = ({found.get("name", ""): found for found in root.findall(kind)} for kind in ("link", "joint"))
    return links, joints


def numbers_of(element: Element, child: str, attribute: str, default: str) -> np.ndarray:
    """Numbers in an attribute of an element's child.

    :param element: element of a URDF
    :param child: path of the child from there
    :param attribute: name of the attribute
    :param default: text of the attribute, where it or the child is left out
    """
    found = element.find(child)
    return np.array((default if found is None else found.get(attribute, default)).split(), float)


def place_of(link: str, joints: Mapping[str, Element]) -> np.ndarray:
    """Place of a link's frame in the root's, with all joints at zero, in m; shape (3,).

    :param link: name of the link
    :param joints: elements of all joints
    """
    place = np.zeros(3)
    joint_of = {child.get("link", ""): joint for joint in joints.values() for child in joint.findall("child")}
    # From the link inwards, as yourdfpy adds: the last bit depends on the order.
    while (joint := joint_of.get(link)) is not None:
        place = numbers_of(joint, "origin", "xyz", "0 0 0") + place
        link = joint.findall("parent")[0].get("link", "")
    return place


def inertia_of(link: Element) -> np.ndarray:
    """Inertia of a link about its centre of mass, in kg m^2; shape (3, 3).

    :param link: element of the link
    """
    pairs = (("xx", "xy", "xz"), ("xy", "yy", "yz"), ("xz", "yz", "zz"))
    return np.array([[numbers_of(link, "inertial/inertia", f"i{pair}", "nan")[0] for pair in row] for row in pairs])
