"""The robot with all of its dimensions: from the front and from the side, and a foot enlarged."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.patheffects import withStroke

from sarah.pictures.dimension_marks import CENTRE_OF_MASS, Mark, Side, marks
from sarah.pictures.link_shapes import outlines
from sarah.pictures.style import own_style
from sarah.robot.description import RobotDescription
from sarah.robot.dimensions import known_dimensions
from sarah.robot.standing import links_of, model_of, together

WIDTH, HEIGHT = 7.6, 6.3
"""Size of the figure, in inches; so are all lengths below."""
FONT_SIZE = 7.0
RESOLUTION = 200
"""Pixels per inch."""
GAP = 0.05
LANE = 0.16
"""Distance of arrows beside the robot from it, and from each other."""
LABEL_WIDTH, LABEL_HEIGHT = 1.07, 0.26
UNDER, OVER = 0.4, 0.65
"""Room under what is framed, and over it, for arrows and the title."""
SHORT = 0.13
"""Length below which an arrow has bars in place of heads."""
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
    :param place: left, bottom, width and height
    :param axes: unit vectors to the right, up and towards the eye, as rows
    :param links: links that the panel shows from end to end; none stands for all
    """

    name: str
    title: str
    place: tuple[float, float, float, float]
    axes: np.ndarray
    links: tuple[str, ...] = ()


PANELS = (
    Panel("front", "from the front", (0.0, 2.1, 3.8, 4.2), FROM_FRONT),
    Panel("side", "from its right", (3.8, 2.1, 3.8, 4.2), FROM_RIGHT),
    Panel("foot side", "right foot, from its right", (0.0, 0.0, 4.4, 2.1), FROM_RIGHT, FOOT),
    Panel("foot front", "right foot, from the front", (4.4, 0.0, 3.2, 2.1), FROM_FRONT, FOOT),
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
    views = [_View(panel, shown[panel.name], robot) for panel in PANELS]
    shared = min(view.scale for view in views if not view.panel.links)  # of the whole robot; a foot has its own
    with own_style({"axes.grid": False, "font.size": FONT_SIZE}):
        figure = plt.figure(figsize=(WIDTH, HEIGHT))
        for view in views:
            view.begin(figure, view.scale if view.panel.links else shared)
            view.draw_robot(robot)
            for mark in view.marks:
                view.draw_mark(mark)
            view.write_names("left", texts, changed)
            view.write_names("right", texts, changed)
        figure.savefig(path, dpi=RESOLUTION)
        plt.close(figure)


def _texts(dimensions: Mapping[str, float]) -> dict[str, str]:
    """Name and value of each dimension, on two lines."""
    known, signs = known_dimensions(), dict.fromkeys(("abduction_limit", "flexion_limit"), "±")
    return {name: f"{name}\n{signs.get(name, '')}{value:.4g} {known[name].unit}" for name, value in dimensions.items()}


class _View:
    """A panel as it is drawn: in metres, with the frame of links and arcs in the middle of its lower edge."""

    def __init__(self, panel: Panel, shown: Sequence[Mark], robot: RobotDescription) -> None:
        self.panel, self.marks = panel, shown
        whole = [outline.corners for outline in self._outlines(robot, panel.links)]
        arcs = [self._seen(mark.points) for mark in shown if len(mark.points) > 2]
        points = np.concatenate(whole + arcs)
        self._frame = np.array((np.minimum(points.min(axis=0), (np.inf, 0.0)), points.max(axis=0)))
        _, _, width, height = panel.place
        free = np.array((width - self._room("left") - self._room("right"), height - UNDER - OVER))
        self.scale = float((free / np.ptp(self._frame, axis=0)).min())
        """Largest scale at which everything has room, in inches per m."""

    def begin(self, figure: Figure, scale: float) -> None:
        """Begin to draw at a scale, in inches per m."""
        place, self._inch = np.array(self.panel.place), 1.0 / scale
        size, (low, high) = place[2:] * self._inch, self._frame
        left = (low + high - size)[0] / 2 + (self._room("right") - self._room("left")) * self._inch / 2
        self._bottom = low[1] - UNDER * self._inch
        self._top = self._bottom + size[1]
        self._axis = figure.add_axes(tuple(place / (WIDTH, HEIGHT, WIDTH, HEIGHT)))
        self._axis.set(xlim=(left, left + size[0]), ylim=(self._bottom, self._top))
        self._axis.axis("off")
        title = self._top - LABEL_HEIGHT / 2 * self._inch
        self._axis.text(left + size[0] / 2, title, self.panel.title, ha="center", va="center")

    def draw_robot(self, robot: RobotDescription) -> None:
        """Draw the links, which end at the frame, the floor, and the contacts of an enlarged foot."""
        (left, low), (right, high), gap = *self._frame, GAP * self._inch
        corner, size = (left - gap, low - gap), (right - left + 2 * gap, high - low + 2 * gap)
        frame = Rectangle(corner, *size, transform=self._axis.transData)
        links = [link for link in model_of(robot).link_map if not self.panel.links or link.startswith("right")]
        for outline in self._outlines(robot, links):
            colour = LIGHTER + (1.0 - LIGHTER) * np.array(outline.colour)
            shape = Polygon(outline.corners, facecolor=colour, edgecolor=0.7 * colour, linewidth=0.3)
            self._axis.add_patch(shape).set_clip_path(frame)
        self._axis.plot((left - gap, right + gap), (0.0, 0.0), color="0.3", linewidth=0.8)
        right_soles = np.array(robot.standing_soles[len(robot.standing_soles) // 2 :])
        for place in self._seen(right_soles) if self.panel.links else ():
            circle = Circle(tuple(place), robot.contact_radius, fill=False, linewidth=0.5, linestyle=":")
            self._axis.add_patch(circle)

    def draw_mark(self, mark: Mark) -> None:
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
        if len(places) > 2:
            outline = [withStroke(linewidth=1.8, foreground="white")]
            self._axis.plot(*places.T, color="black", linewidth=0.7, path_effects=outline)
        length = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
        head = "-|>,head_length=0.3,head_width=0.12" if length > SHORT * self._inch else "|-|,widthA=0,widthB=0.12"
        arrow = {"arrowstyle": head, "linewidth": 0.7, "color": "black", "shrinkA": 0, "shrinkB": 0}
        for last, before in [(-1, -2), (0, 1)][: 1 + mark.has_two_heads]:
            self._axis.annotate("", places[last], places[before], arrowprops=arrow)

    def write_names(self, side: Side, texts: Mapping[str, str], bold: set[str]) -> None:
        """Write the names on a side in a column, in the order of what they name, with a line to each."""
        from scipy.optimize import isotonic_regression

        anchors = {mark.name: self._anchor(mark) for mark in self.marks if mark.side == side}
        named = sorted(anchors.items(), key=lambda pair: -pair[1][1])
        if not named:
            return
        label = LABEL_HEIGHT * self._inch
        steps = label * np.arange(len(named))
        wanted = np.array([anchor[1] for _, anchor in named]) + steps
        heights = isotonic_regression(wanted, increasing=False).x
        heights = np.clip(heights, self._bottom + label / 2 + steps[-1], self._top - 1.5 * label) - steps
        x = self._edge(side, self._lanes(side))
        gap, align = (GAP, "left") if side == "right" else (-GAP, "right")
        for (name, anchor), height in zip(named, heights, strict=True):
            self._axis.plot((anchor[0], x), (anchor[1], height), color="black", linewidth=0.4)
            weight = "bold" if name in bold else "normal"
            self._axis.text(x + gap * self._inch, height, texts[name], ha=align, va="center", weight=weight)

    def _outlines(self, robot: RobotDescription, links: Sequence[str]) -> Any:
        return outlines(model_of(robot), links, robot.standing_height, self.panel.axes)

    def _seen(self, points: np.ndarray) -> np.ndarray:
        """Points of the world to the right and up."""
        return np.asarray(points @ self.panel.axes[:2].T)

    def _room(self, side: Side) -> float:
        """Room for lanes and names on a side, in inches."""
        has_names = any(mark.side == side for mark in self.marks)
        return LANE * self._lanes(side) + (LABEL_WIDTH if has_names else 0.0)

    def _lanes(self, side: Side) -> int:
        """Number of lanes from the frame to the names on a side."""
        return max((mark.lane for mark in self.marks if mark.beside == side), default=0) + 1

    def _edge(self, side: str, lane: int) -> float:
        """Place of a lane across its side; lane 0 is the edge of the frame."""
        end, across = EDGES[side]
        return float(self._frame[end, across] + (2 * end - 1) * LANE * lane * self._inch)

    def _places(self, mark: Mark) -> np.ndarray:
        """Places of a mark's points; an arrow beside the robot is in its lane."""
        places = self._seen(mark.points)
        if mark.beside:
            places[:, EDGES[mark.beside][1]] = self._edge(mark.beside, mark.lane)
        return places

    def _anchor(self, mark: Mark) -> np.ndarray:
        """Place to which a name's line leads: the middle of an arrow beside the robot, and else the nearest head."""
        places = self._places(mark)
        if mark.beside == mark.side:
            return np.asarray(places.mean(axis=0))
        heads = places[[0, -1]] if mark.has_two_heads else places[-1:]
        return np.asarray(max(heads, key=lambda place: place[0] if mark.side == "right" else -place[0]))
