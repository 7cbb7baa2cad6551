"""The robot with all of its dimensions: from the front and from the side, and a foot enlarged."""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon, Rectangle
from matplotlib.patheffects import withStroke

from sarah.pictures.dimension_layout import LABEL_HEIGHT, TITLE_HEIGHT, Layout, Panel
from sarah.pictures.dimension_marks import CENTRE_OF_MASS, Mark, Side, marks
from sarah.pictures.link_shapes import outlines
from sarah.pictures.style import own_style
from sarah.robot.description import RobotDescription
from sarah.robot.dimensions import known_dimensions
from sarah.robot.standing import links_of, model_of, together

WIDTH = 7.6
"""Width of the figure, in inches; so are all lengths below."""
FONT_SIZE = 7.0
RESOLUTION = 200
"""Pixels per inch."""
GAP = 0.05
SHORT = 0.13
"""Length below which an arrow has bars in place of heads."""
LIGHTER = 0.45
"""Share of white in the robot's colours, so that arrows stand out."""
FROM_FRONT = np.array(((-1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, 1.0, 0.0)))
FROM_RIGHT = np.array(((0.0, 1.0, 0.0), (0.0, 0.0, 1.0), (1.0, 0.0, 0.0)))
FOOT = ("right_forefoot", "right_hindfoot")
ROWS = (
    {
        "front": Panel("from the front", 0.0, 3.8, 5.5, FROM_FRONT),
        "side": Panel("from its right", 3.8, 3.8, 5.5, FROM_RIGHT),
    },
    {
        "foot side": Panel("right foot, from its right", 0.0, 4.4, 1.6, FROM_RIGHT, FOOT),
        "foot front": Panel("right foot, from the front", 4.4, 3.2, 1.6, FROM_FRONT, FOOT),
    },
)
"""Panels by the name of their marks, row by row from the top."""


class Name(NamedTuple):
    """Text beside a mark.

    :param text: name and value, on two lines
    :param weight: weight of the font: bold if the value is not the default
    """

    text: str
    weight: str


def draw_dimensions(robot: RobotDescription, dimensions: Mapping[str, float], path: Path) -> None:
    """Draw the standing robot with an arrow, an arc or a dot for each of its dimensions.

    :param robot: robot to draw
    :param dimensions: values of all its dimensions, in SI units; those that differ from their defaults are bold
    :param path: path of the picture, a PNG
    """
    model = model_of(robot)
    centre = together(links_of(robot).values()).centre
    shown = marks(dimensions, centre)
    names = _names(dimensions) | {CENTRE_OF_MASS: Name(f"{CENTRE_OF_MASS}\n{centre[2]:.3g} m high", "normal")}
    rows = [[_layout(panel, shown[name], robot, model) for name, panel in row.items()] for row in ROWS]
    height = 0.0
    for row in reversed(rows):
        height += _fit(row, height)
    with own_style({"axes.grid": False, "font.size": FONT_SIZE}):
        figure = plt.figure(figsize=(WIDTH, height))
        axis = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(0.0, WIDTH), ylim=(0.0, height))
        axis.axis("off")
        for layout in itertools.chain(*rows):
            _draw_robot(axis, layout, robot, model)
            for mark in layout.marks:
                _draw_mark(axis, layout, mark)
            _name_beside(axis, layout, "left", names)
            _name_beside(axis, layout, "right", names)
            _name_along(axis, layout, names)
        figure.savefig(path, dpi=RESOLUTION)
        plt.close(figure)


def _fit(row: list[Layout], bottom: float) -> float:
    """Fit a row of panels, and return its height; the whole robot has one scale in all of them, a foot its own."""
    shared = min(layout.largest_scale for layout in row)
    scales = [layout.largest_scale if layout.panel.links else shared for layout in row]
    height = max(layout.height(scale) for layout, scale in zip(row, scales, strict=True))
    for layout, scale in zip(row, scales, strict=True):
        layout.fit(scale, bottom, height)
    return height


def _names(dimensions: Mapping[str, float]) -> dict[str, Name]:
    known, signs = known_dimensions(), dict.fromkeys(("abduction_limit", "flexion_limit"), "±")
    return {
        name: Name(
            f"{name}\n{signs.get(name, '')}{value:.4g} {known[name].unit}",
            "normal" if value == known[name].default else "bold",
        )
        for name, value in dimensions.items()
    }


def _layout(panel: Panel, shown: list[Mark], robot: RobotDescription, model: Any) -> Layout:
    """Layout in which the panel's links and arcs have room, and the floor under them."""
    flat = [mark.seen(panel.axes) for mark in shown]
    whole = [outline.corners for outline in outlines(model, panel.links, robot.standing_height, panel.axes)]
    arcs = [mark.points for mark in flat if len(mark.points) > 2]
    points = np.concatenate(whole + arcs)
    return Layout(panel, flat, np.concatenate((points, [(points[0, 0], 0.0)])))


def _draw_robot(axis: Axes, layout: Layout, robot: RobotDescription, model: Any) -> None:
    """Draw the links, which end at the frame, the floor, and the contacts of an enlarged foot."""
    panel, (width, height) = layout.panel, layout.high - layout.low
    axis.text(panel.left + panel.width / 2, layout.top + TITLE_HEIGHT / 2, panel.title, ha="center")
    frame = Rectangle(tuple(layout.low - GAP), width + 2 * GAP, height + 2 * GAP, transform=axis.transData)
    links = [link for link in model.link_map if not panel.links or link.startswith("right")]
    for outline in outlines(model, links, robot.standing_height, panel.axes):
        colour = LIGHTER + (1.0 - LIGHTER) * np.array(outline.colour)
        places = layout.at(outline.corners)
        axis.add_patch(Polygon(places, facecolor=colour, edgecolor=0.7 * colour, linewidth=0.3)).set_clip_path(frame)
    y = layout.at(np.zeros((1, 2)))[0, 1]
    axis.plot((layout.low[0] - GAP, layout.high[0] + GAP), (y, y), color="0.3", linewidth=0.8)
    right_soles = np.array(robot.standing_soles[len(robot.standing_soles) // 2 :])
    for place in layout.at(right_soles @ panel.axes[:2].T) if panel.links else ():
        axis.add_patch(
            Circle(tuple(place), layout.scale * robot.contact_radius, fill=False, linewidth=0.5, linestyle=":")
        )


def _draw_mark(axis: Axes, layout: Layout, mark: Mark) -> None:
    places, seen = layout.places(mark), layout.at(mark.points)
    if len(places) == 1:
        _draw_dot(axis, places[0], mark.name)
        return
    thin = list(zip(seen, places, strict=True)) if mark.is_beside else []
    thin += [(centre, end) for centre in layout.at(mark.centre) for end in (places[0], places[-1])]
    for first, last in thin:
        axis.plot(*zip(first, last, strict=True), color="0.4", linewidth=0.4)
    if len(places) > 2:
        outline = [withStroke(linewidth=1.8, foreground="white")]
        axis.plot(*places.T, color="black", linewidth=0.7, path_effects=outline)
    length = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    head = "-|>,head_length=0.3,head_width=0.12" if length > SHORT else "|-|,widthA=0,widthB=0.12"
    arrow = {"arrowstyle": head, "linewidth": 0.7, "color": "black", "shrinkA": 0, "shrinkB": 0}
    for last, before in [(-1, -2), (0, 1)][: 1 + mark.has_two_heads]:
        axis.annotate("", places[last], places[before], arrowprops=arrow)


def _draw_dot(axis: Axes, place: np.ndarray, name: str) -> None:
    if name == CENTRE_OF_MASS:
        axis.plot(*place, "o", markersize=7, color="black", fillstyle="left", markerfacecoloralt="white")
    else:
        axis.plot(*place, "o", markersize=2.5, color="black", markeredgecolor="white", markeredgewidth=0.5)


def _name_beside(axis: Axes, layout: Layout, side: Side, names: Mapping[str, Name]) -> None:
    """Write the names on the left or right in a column, in the order of what they name, with a line to each."""
    from scipy.optimize import isotonic_regression

    named = sorted((tuple(_anchor(layout, mark)), mark.name) for mark in layout.on(side))
    named.sort(key=lambda pair: -pair[0][1])
    if not named:
        return
    steps = LABEL_HEIGHT * np.arange(len(named))
    top, bottom = layout.top - LABEL_HEIGHT / 2, layout.names_at("bottom") + LABEL_HEIGHT / 2
    wanted = np.array([y for (_, y), _ in named]) + steps
    heights = np.clip(isotonic_regression(wanted, increasing=False).x, bottom + steps[-1], top) - steps
    x, gap, align = layout.names_at(side), *((GAP, "left") if side == "right" else (-GAP, "right"))
    for (anchor, name), height in zip(named, heights, strict=True):
        axis.plot((anchor[0], x), (anchor[1], height), color="black", linewidth=0.4)
        axis.text(x + gap, height, names[name].text, ha=align, va="center", weight=names[name].weight)


def _anchor(layout: Layout, mark: Mark) -> np.ndarray:
    """Place to which a name's line leads: the middle of an arrow in a lane, and else the nearest head."""
    places = layout.places(mark)
    if mark.is_beside:
        return np.asarray(places.mean(axis=0))
    heads = places[[0, -1]] if mark.has_two_heads else places[-1:]
    return np.asarray(max(heads, key=lambda place: place[0] if mark.side == "right" else -place[0]))


def _name_along(axis: Axes, layout: Layout, names: Mapping[str, Name]) -> None:
    """Write the names above and below their arrows; those below begin at the arrow's first point, away from others."""
    for mark in layout.on("top"):
        x = layout.places(mark)[:, 0].mean()
        name = names[mark.name]
        axis.text(x, layout.names_at("top") + GAP, name.text, ha="center", va="bottom", weight=name.weight)
    for mark in layout.on("bottom"):
        (first, _), (last, _) = layout.places(mark)
        gap, align = (GAP, "left") if last > first else (-GAP, "right")
        name = names[mark.name]
        axis.text(first + gap, layout.names_at("bottom") - GAP, name.text, ha=align, va="top", weight=name.weight)
