"""The paper's Figure 2: the robot with its groups, joints and sensors, drawn from the URDF that is simulated."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patheffects import withStroke

from sarah.pictures.colours import LEFT, RIGHT
from sarah.pictures.link_shapes import shapes_of
from sarah.pictures.style import COLUMN_WIDTH, own_style, save
from sarah.robot.description import ANKLE_JOINTS, GROUPS, JOINT_AXES, JOINT_TYPES, RobotDescription, model_of
from sarah.scenery.camera import Camera, View
from sarah.simulation.renderer import Renderer

CAMERA = Camera(height=0.46, distance=2.3, yaw=152.0, pitch=-9.0)
HEIGHT = 1.3 * COLUMN_WIDTH
PIXELS_PER_INCH = 300
TRIAD = (0.07, 0.50, 0.0)
"""Place of the origin of the drawn axes, on the floor, in m, beside the standard robot."""
TRIAD_LENGTH, TRIAD_NAMES = 0.10, 0.135
"""Distances of the axes' tips and of their names from the origin, in m, beside the standard robot."""
UP_AXIS = 2


@dataclass(frozen=True)
class Label:
    """Words beside the robot, and the point of the robot that they name.

    :param text: words, on one line or two
    :param point: point in the world's frame, in m; shape (3,)
    :param height: height of the words, from 0 at the picture's lower edge to 1
    :param is_left: whether the words stand on the picture's left
    :param colour: colour of the words
    """

    text: str
    point: np.ndarray
    height: float
    is_left: bool
    colour: str = "black"


def labels_of(robot: RobotDescription) -> list[Label]:
    """Labels of a robot's groups, joints and sensors.

    :param robot: robot, which stands with all joints at zero
    """
    model, shapes = model_of(robot.urdf), list(shapes_of(robot))
    torso = np.array((0.0, 0.0, robot.standing_height))

    def at(link: str, x: float = 0.0, y: float = 0.0, z: float = 0.0) -> np.ndarray:
        """Point of a link's frame, or the nearest in the box around the link's shapes, in the world's frame."""
        points = np.concatenate([shape.points for shape in shapes if shape.link == link])
        point = torso + model.get_transform(link, "torso")[:3, 3] + (x, y, z)
        return np.clip(point, points.min(axis=0), points.max(axis=0))

    kilograms = {group: f"{sum(robot.masses[link] for link in links):.3g} kg" for group, links in GROUPS.items()}
    (_, sole_y, sole_z), (outer, _, _) = robot.soles["right_forefoot"][0], max(robot.soles["right_forefoot"])
    thigh = model.get_transform("left_shank", "left_thigh")[UP_AXIS, 3]
    return [
        Label(f"(a) top group\n{kilograms['top']}", at("torso", -0.02, 0.1, 0.13), 0.93, True, "#5A6470"),
        Label("inertial\nmeasurement unit", at("torso", 0.0, 0.03), 0.79, True),
        Label(
            f"(b) right leg\n{kilograms['right leg']}", at("right_thigh", 0.04, 0.03, 0.6 * thigh), 0.55, True, RIGHT
        ),
        Label("pressure pads,\nfore and hind", at("right_forefoot", 0.0, sole_y), 0.29, True),
        Label("shoe,\ncut open", at("right_forefoot", 1.15 * outer, 0.7 * sole_y, sole_z), 0.15, True),
        Label(_joint(robot, "left_hip_abduction"), at("left_hip", 0.0, 0.06), 0.79, False),
        Label(_joint(robot, "left_hip_flexion"), at("left_thigh", 0.036, 0.033), 0.66, False),
        Label(f"(c) left leg\n{kilograms['left leg']}", at("left_thigh", 0.01, 0.04, 0.62 * thigh), 0.54, False, LEFT),
        Label(_joint(robot, "left_leg_length"), at("left_shank", 0.0, 0.03, 0.2 * thigh), 0.43, False),
        Label(_joint(robot, "left_hindfoot"), at("left_hindfoot", 0.03, -0.65 * sole_y), 0.28, False),
        Label(_joint(robot, "left_forefoot"), at("left_forefoot", 0.03, 0.75 * sole_y), 0.16, False),
    ]


def _joint(robot: RobotDescription, joint: str) -> str:
    """Text with a joint's name, axis and limits."""
    name = joint.split("_", 1)[1].replace("_", " ")
    if joint in ANKLE_JOINTS:
        return f"{name},\npassive"
    axis = "xyz"[int(np.flatnonzero(JOINT_AXES[joint])[0])]
    low, high = robot.limits[joint]
    if JOINT_TYPES[joint] == "prismatic":
        return f"{name} (“knee”)\n{1000 * low:+.0f} to {1000 * high:+.0f} mm".replace("-", "\N{MINUS SIGN}")
    return f"{name}, about {axis}\n{low:+g} to {high:+g} rad".replace("-", "\N{MINUS SIGN}")


def draw_robot(robot: RobotDescription, path: Path) -> list[Path]:
    """Draw the standing robot with its groups, joints and sensors named.

    :param robot: robot to draw
    :param path: path of the picture, without suffix
    :return: the files, PNG and PDF
    """
    width, height = round(COLUMN_WIDTH * PIXELS_PER_INCH), round(HEIGHT * PIXELS_PER_INCH)
    pose = ((0.0, 0.0, robot.standing_height), (0.0, 0.0, 0.0, 1.0), dict.fromkeys(robot.limits, 0.0))
    triad = robot.scale.length * (TRIAD + np.vstack((np.zeros(3), TRIAD_LENGTH * np.eye(3), TRIAD_NAMES * np.eye(3))))
    renderer = Renderer(robot)
    try:
        seen = np.concatenate((renderer.seen(*pose), triad))
        camera = CAMERA.scaled(robot.scale.length).seeing(seen, width, height)
        picture = renderer.draw(*pose, width, height, camera)
    finally:
        renderer.close()
    view = View(width, height, camera)
    with own_style({"axes.grid": False}):
        figure = plt.figure(figsize=(COLUMN_WIDTH, HEIGHT))
        axis = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axis.axis("off")
        axis.imshow(picture)
        for label in labels_of(robot):
            _draw_label(axis, view, label)
        _draw_triad(axis, view.pixels(triad))
        return save(figure, path)


def _draw_label(axis: Axes, view: View, label: Label) -> None:
    outline = [withStroke(linewidth=2.0, foreground="white")]
    axis.annotate(
        label.text,
        view.pixels(label.point[None])[0],
        (0.015 if label.is_left else 0.985, label.height),
        textcoords="axes fraction",
        ha="left" if label.is_left else "right",
        va="center",
        fontsize=6.5,
        color=label.colour,
        path_effects=outline,
        arrowprops={
            "arrowstyle": "-",
            "linewidth": 0.6,
            "color": "black",
            "shrinkB": 0,
            "relpos": (1.0 if label.is_left else 0.0, 0.5),
        },
    )
    axis.plot(*view.pixels(label.point[None])[0], "o", markersize=2.5, color="black", markeredgecolor="white", mew=0.5)


def _draw_triad(axis: Axes, pixels: np.ndarray) -> None:
    """Draw the axes of torso and world: x to the robot's right, y forward, z up."""
    origin, *ends = pixels
    for name, tip, text in zip("xyz", ends[:3], ends[3:], strict=True):
        axis.annotate("", tip, origin, arrowprops={"arrowstyle": "->", "linewidth": 0.8, "shrinkA": 0, "shrinkB": 0})
        axis.text(text[0], text[1], name, ha="center", va="center", fontsize=7)
