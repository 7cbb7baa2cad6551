"""The arrow of a push in pictures."""

from __future__ import annotations

import numpy as np
from PIL import ImageDraw

from sarah.robot.scale import Scale
from sarah.scenery.camera import View

PUSH = "#8C2B8F"
"""Colour of a push."""
METRES_PER_NEWTON = 0.005
"""Length of a push's arrow per force, in m/N, beside the standard robot; in proportion to weight and height of
others."""
LONGEST_ARROW = 1.0
"""Length of the longest arrow, in m, beside the standard robot: a force above 200 N is told by words alone."""
STANDARD = Scale()
"""Size of the standard robot."""
LINES_OF_TEXT = 40
"""Height of a picture as a multiple of the unit in which the arrow's width is measured."""


def arrow(head: np.ndarray, force: np.ndarray, scale: Scale = STANDARD) -> np.ndarray:
    """Head and tail of a push's arrow, as rows.

    :param head: position of the torso's centre, where the arrow ends, in m; shape (3,)
    :param force: force of the push, in N; shape (3,)
    :param scale: size of the robot
    """
    newtons = max(float(np.linalg.norm(force)), 1e-9)
    length = scale.length * min(METRES_PER_NEWTON * newtons / scale.mass, LONGEST_ARROW)
    return np.array((head, head - length / newtons * force))


def draw_arrow(pen: ImageDraw.ImageDraw, view: View, ends: np.ndarray) -> None:
    """Draw a push's arrow over a picture.

    :param pen: pen of the picture
    :param view: projection of the picture
    :param ends: head and tail of the arrow, as :func:`arrow` gives them
    """
    unit = view.height / LINES_OF_TEXT
    tip, end = view.pixels(ends)
    along = tip - end
    length = max(1.0, float(np.hypot(*along)))
    along = along / length
    across = np.array((-along[1], along[0]))
    neck = tip - min(1.6 * unit, 0.7 * length) * along
    pen.line((*end, *neck), fill=PUSH, width=round(0.6 * unit))
    pen.polygon([tuple(tip), tuple(neck + 0.9 * unit * across), tuple(neck - 0.9 * unit * across)], fill=PUSH)
