"""The robot with all of its dimensions: from the front and from the side, and a foot enlarged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, Polygon
from matplotlib.path import Path as Line
from matplotlib.patheffects import withStroke
from matplotlib.transforms import blended_transform_factory

from sarah.pictures.dimension_marks import CENTRE_OF_MASS, Mark, Side, marks
from sarah.pictures.link_shapes import shapes_of
from sarah.pictures.style import own_style
from sarah.robot.description import RobotDescription
from sarah.robot.dimensions import known_dimensions
from sarah.robot.standing import links_of, together

SIZE = (7.6, 6.3)
"""Width and height of the figure, in inches."""
FONT_SIZE = 7.0
RESOLUTION = 200
"""Pixels per inch."""
LANE = 0.05
"""Distance of arrows beside the robot from it and from each other, as a share of the panel's longer side."""
MARGIN = 2.3
"""Room for arrows around the robot, in lanes."""
GAP = 0.03
"""Distance between names and their lines, as a share of the panel's width."""
NAME_HEIGHT = 0.042
"""Distance between names in a column, as a share of the figure's height."""
LIGHTER = 0.45
"""Share of white in the robot's colours, so that arrows stand out."""
FROM_FRONT = np.array(((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)))
FROM_RIGHT = np.array(((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)))
FOOT = ("right_forefoot", "right_hindfoot")
EDGES = {"left": (0, 0), "right": (1, 0), "bottom": (0, 1), "top": (1, 1)}
"""End of the frame on each side, 0 for the lower one, and the axis across that side."""


class Panel(NamedTuple):
    """A part of the figure.

    :param name: name of its marks
    :param title: title
    :param place: left, bottom, width and height of the robot and its arrows, as shares of the figure; names are beside
    :param axes: unit vectors to the right, up and towards the eye, as rows
    :param links: links that the panel shows from end to end; none stands for all
    """

    name: str
    title: str
    place: tuple[float, float, float, float]
    axes: np.ndarray
    links: tuple[str, ...] = ()


PANELS = (
    Panel("front", "from the front", (0.15, 0.36, 0.2, 0.6), FROM_FRONT),
    Panel("side", "from its right", (0.65, 0.36, 0.2, 0.6), FROM_RIGHT),
    Panel("foot side", "right foot, from its right", (0.15, 0.01, 0.3, 0.29), FROM_RIGHT, FOOT),
    Panel("foot front", "right foot, from the front", (0.65, 0.01, 0.2, 0.29), FROM_FRONT, FOOT),
)


def draw_dimensions(robot: RobotDescription, dimensions: Mapping[str, float], path: Path) -> None:
    """Draw the standing robot with an arrow, an arc or a dot for each of its dimensions.

    :param robot: robot to draw
    :param dimensions: values of all its dimensions, in SI units; those that differ from their defaults are bold
    :param path: path of the picture, a PNG
    """
    centre = together(links_of(robot).values()).centre
    shown = marks(dimensions, centre)
    texts = _texts(dimensions) | {CENTRE_OF_MASS: f"{CENTRE_OF_MASS}\n{centre[2]:.3g} m high"}
    changed = {name for name, value in dimensions.items() if value != known_dimensions()[name].default}
    with own_style({"axes.grid": False, "font.size": FONT_SIZE}):
        figure = plt.figure(figsize=SIZE)
        for panel in PANELS:
            view = _View(figure, panel, shown[panel.name], robot)
            view.write_names("left", texts, changed)
            view.write_names("right", texts, changed)
        figure.savefig(path, dpi=RESOLUTION)
        plt.close(figure)


def _texts(dimensions: Mapping[str, float]) -> dict[str, str]:
    """Name and value of each dimension, on two lines."""
    known, signs = known_dimensions(), dict.fromkeys(("abduction_limit", "flexion_limit"), "±")
    return {name: f"{name}\n{signs.get(name, '')}{value:.4g} {known[name].unit}" for name, value in dimensions.items()}


class _View:
    """Robot and marks of a panel, in metres to the right and up."""

    def __init__(self, figure: Figure, panel: Panel, shown: Sequence[Mark], robot: RobotDescription) -> None:
        self._figure, self._panel, self._marks = figure, panel, shown
        shapes = [shape for shape in shapes_of(robot) if not panel.links or shape.link.startswith("right")]
        whole = [shape.points for shape in shapes if shape.link in panel.links or not panel.links]
        points = self._seen(np.concatenate([*whole, *(mark.points for mark in shown)]))
        self._frame = np.array((points.min(axis=0), points.max(axis=0)))
        self._lane = LANE * float(np.ptp(self._frame, axis=0).max())
        self._axis = figure.add_axes(panel.place, aspect="equal")
        (left, bottom), (right, top) = self._frame + MARGIN * self._lane * np.array(((-1.0,), (1.0,)))
        self._axis.set(xlim=(left, right), ylim=(bottom, top))
        self._axis.axis("off")
        x, y, width, height = panel.place
        figure.text(x + width / 2, y + height, panel.title, ha="center", va="bottom")
        for shape in sorted(shapes, key=lambda shape: (shape.points @ panel.axes[2]).max()):
            self._draw_link(shape.points, LIGHTER + (1.0 - LIGHTER) * shape.colour)
        self._axis.axhline(0.0, color="0.3", linewidth=0.8)
        if panel.links:
            for place in self._seen(np.array(robot.standing_soles)):
                circle = Circle(tuple(place), robot.contact_radius, fill=False, linewidth=0.5, linestyle=":")
                self._axis.add_patch(circle)
        for mark in shown:
            self._draw_mark(mark)

    def _draw_link(self, points: np.ndarray, colour: np.ndarray) -> None:
        from scipy.spatial import ConvexHull

        seen = self._seen(points)
        corners = seen[ConvexHull(seen).vertices]
        self._axis.add_patch(Polygon(corners, facecolor=colour, edgecolor=0.7 * colour, linewidth=0.3))

    def _draw_mark(self, mark: Mark) -> None:
        """Draw a mark without its name."""
        places, seen = self._places(mark), self._seen(mark.points)
        if mark.name == CENTRE_OF_MASS:
            self._axis.plot(*places[0], "o", markersize=7, color="black", fillstyle="left", markerfacecoloralt="white")
        elif len(places) == 1:
            self._axis.plot(*places[0], "o", markersize=2.5, color="black", markeredgecolor="white", mew=0.5)
        if len(places) == 1:
            return
        thin = list(zip(seen, places, strict=True)) if mark.beside else []
        thin += [(centre, end) for centre in self._seen(mark.centre) for end in (places[0], places[-1])]
        for first, last in thin:
            self._axis.plot(*zip(first, last, strict=True), color="0.4", linewidth=0.4)
        length = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
        style = "|-|,widthA=0.8,widthB=0.8"
        if length > self._lane:
            style = f"{'<|-|>' if mark.has_two_heads else '-|>'},head_length=2,head_width=0.8"
        outline = [withStroke(linewidth=1.8, foreground="white")]
        arrow = FancyArrowPatch(path=Line(places), arrowstyle=style, linewidth=0.7, color="black", path_effects=outline)
        self._axis.add_patch(arrow)

    def write_names(self, side: Side, texts: Mapping[str, str], bold: set[str]) -> None:
        """Write the names on a side in a column, in the order of what they name, with a line to each."""
        from scipy.optimize import isotonic_regression

        anchors = {mark.name: self._anchor(mark) for mark in self._marks if mark.side == side}
        named = sorted(anchors.items(), key=lambda pair: -pair[1][1])
        if not named:
            return
        self._axis.apply_aspect()
        to_figure = self._axis.transData + self._figure.transFigure.inverted()
        wanted = to_figure.transform([anchor for _, anchor in named])[:, 1]
        _, bottom, _, height = self._panel.place
        steps = NAME_HEIGHT * np.arange(len(named))
        heights = isotonic_regression(wanted + steps, increasing=False).x
        heights = np.clip(heights, bottom + NAME_HEIGHT / 2 + steps[-1], bottom + height - NAME_HEIGHT / 2) - steps
        x, gap, align = (0.0, -GAP, "right") if side == "left" else (1.0, GAP, "left")
        beside = blended_transform_factory(self._axis.transAxes, self._figure.transFigure)
        line = {"arrowstyle": "-", "linewidth": 0.4, "shrinkA": 0.0, "shrinkB": 0.0}
        for (name, anchor), y in zip(named, heights, strict=True):
            self._axis.annotate("", tuple(anchor), (x, y), textcoords=beside, arrowprops=line)
            weight = "bold" if name in bold else "normal"
            self._axis.text(x + gap, y, texts[name], ha=align, va="center", weight=weight, transform=beside)

    def _seen(self, points: np.ndarray) -> np.ndarray:
        """Points of the world to the right and up."""
        return np.asarray(points @ self._panel.axes[:2].T)

    def _places(self, mark: Mark) -> np.ndarray:
        """Places of a mark's points; an arrow beside the robot is in its lane."""
        places = self._seen(mark.points)
        if mark.beside:
            end, across = EDGES[mark.beside]
            places[:, across] = self._frame[end, across] + (2 * end - 1) * mark.lane * self._lane
        return places

    def _anchor(self, mark: Mark) -> np.ndarray:
        """Place to which a name's line leads: the middle of an arrow beside the robot, and else the nearest head."""
        places = self._places(mark)
        if mark.beside == mark.side:
            return np.asarray(places.mean(axis=0))
        heads = places[[0, -1]] if mark.has_two_heads else places[-1:]
        return np.asarray(max(heads, key=lambda place: place[0] if mark.side == "right" else -place[0]))
