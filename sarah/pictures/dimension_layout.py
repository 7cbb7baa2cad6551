"""Where everything is in a drawing with dimensions: the robot, arrows beside it in lanes, and names around them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from sarah.pictures.dimension_marks import Mark, Side

LABEL_WIDTH, LABEL_HEIGHT, TITLE_HEIGHT = 1.07, 0.26, 0.25
"""Sizes of names and titles, in inches; so are all lengths of a figure."""
LANE = 0.16
"""Distance of arrows beside the robot from it, and from each other."""
SIDES: tuple[Side, ...] = ("left", "right", "top", "bottom")


class Panel(NamedTuple):
    """A part of the figure.

    :param title: title
    :param left: left edge
    :param width: width
    :param tallest: largest height of what is drawn
    :param axes: unit vectors to the right, up and towards the eye, as rows
    :param links: links that the panel shows from end to end; none stands for all
    """

    title: str
    left: float
    width: float
    tallest: float
    axes: np.ndarray
    links: tuple[str, ...] = ()


class Layout:
    """Places within a panel.

    :param panel: panel
    :param marks: its marks, flat
    :param framed: points that it has to show, to the right and up, in m; shape (n, 2)
    """

    def __init__(self, panel: Panel, marks: Sequence[Mark], framed: np.ndarray) -> None:
        self.panel, self.marks = panel, marks
        self._lanes = {name: lane for side in SIDES for name, lane in self._lanes_on(side).items()}
        self._low, self._size = framed.min(axis=0), np.ptp(framed, axis=0)
        self._free_width = panel.width - self._room("left") - self._room("right")
        self.largest_scale = float(min(self._free_width / self._size[0], panel.tallest / self._size[1]))
        """Largest scale at which everything has room, in inches per m."""

    def height(self, scale: float) -> float:
        """Height that the panel needs.

        :param scale: scale, in inches per m
        """
        names = LABEL_HEIGHT * max(len(self.on("left")), len(self.on("right")))
        return TITLE_HEIGHT + max(names, self._room("top") + scale * float(self._size[1])) + self._room("bottom")

    def fit(self, scale: float, bottom: float, height: float) -> None:
        """Choose scale and place: the robot stands in the middle of the panel's lower edge.

        :param scale: scale, in inches per m
        :param bottom: lower edge of the panel
        :param height: height of the panel
        """
        self.scale, self.top = scale, bottom + height - TITLE_HEIGHT
        left = self.panel.left + self._room("left") + (self._free_width - scale * self._size[0]) / 2
        self.low = np.array((left, bottom + self._room("bottom")))
        """Lower left corner of what is framed."""
        self.high = self.low + scale * self._size
        """Upper right corner of what is framed."""

    def on(self, side: Side) -> list[Mark]:
        """Marks whose names are on a side.

        :param side: side of the panel
        """
        return [mark for mark in self.marks if mark.side == side]

    def at(self, points: np.ndarray) -> np.ndarray:
        """Places of points.

        :param points: points to the right and up, in m; shape (n, 2)
        """
        return np.asarray(self.low + self.scale * (points - self._low))

    def places(self, mark: Mark) -> np.ndarray:
        """Places of a mark's points; an arrow beside the robot is in its lane.

        :param mark: mark
        """
        places = self.at(mark.points)
        if mark.is_beside:
            places[:, _across(mark.side)] = self.edge(mark.side, self._lanes[mark.name])
        return places

    def names_at(self, side: Side) -> float:
        """Place across a side at which its names begin.

        :param side: side of the panel
        """
        return self.edge(side, self._count(side) + (side in ("left", "right")))

    def edge(self, side: Side, lane: int = 0) -> float:
        """Place of a lane across its side.

        :param side: side of the panel
        :param lane: number of the lane; 0 is the robot's edge
        """
        across = _across(side)
        if side in ("right", "top"):
            return float(self.high[across] + LANE * lane)
        return float(self.low[across] - LANE * lane)

    def _lanes_on(self, side: Side) -> dict[str, int]:
        """Lane of each arrow beside the robot, counted from 1: those that would overlap are in different ones."""
        taken: list[list[tuple[float, float]]] = []
        lanes = {}
        for mark in self.on(side):
            if mark.is_beside:
                low, high = sorted(mark.points[:, 1 - _across(side)])
                is_free = [all(high <= start + 1e-9 or end <= low + 1e-9 for start, end in spans) for spans in taken]
                lane = [*is_free, True].index(True)
                taken += [[]] * (lane == len(taken))
                taken[lane] = [*taken[lane], (low, high)]
                lanes[mark.name] = lane + 1
        return lanes

    def _count(self, side: Side) -> int:
        return max((self._lanes.get(mark.name, 0) for mark in self.on(side)), default=0)

    def _room(self, side: Side) -> float:
        """Room for lanes and names on a side; all robots stand at one height."""
        if side in ("left", "right"):
            return LANE * (self._count(side) + 1) + (LABEL_WIDTH if self.on(side) else 0.0)
        return LANE * 2 + LABEL_HEIGHT if self.on(side) or side == "bottom" else 0.0


def _across(side: Side) -> int:
    """Axis across a side: 0 to the right, 1 up."""
    return 0 if side in ("left", "right") else 1
