"""The text and symbols over a video's frames."""

from __future__ import annotations

import math
import textwrap
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from sarah.episode.push import push_words
from sarah.episode.trace import Trace
from sarah.pictures.colours import LEFT, PHASE_COLOURS, PUSH, RIGHT
from sarah.robot.reading import Side, Vector
from sarah.robot.scale import Scale
from sarah.scenery.camera import View
from sarah.scenery.push_arrow import LINES_OF_TEXT, STANDARD, arrow, draw_arrow

INK, PALE_INK = "#1B1F24", "#5A6470"
OUTLINE: dict[str, Any] = {"stroke_width": 2, "stroke_fill": "white"}
"""Outline of words that may stand before the robot."""
LABEL_OFFSET = np.array((0.26, 0.20, 0.0))
"""Position of the arrow's label from the torso's centre: to the right, upward and ahead in the picture, in m."""
MOST_LINES = 7
"""Largest number of a caption's lines; of a longer one, an ellipsis follows. More would reach the strip of phases."""
STRIP_SECONDS = 2.0
"""Length of the past that the strip of phases shows, in s."""


class Overlay:
    """Draws text and symbols over the frames of one episode.

    :param trace: trace of the episode
    :param view: view of the camera
    :param caption: text in the lower left corner, of any length
    :param caption_end: pixels from the picture's left edge at which the caption must end
    :param scale: size of the robot
    """

    def __init__(self, trace: Trace, view: View, caption: str, caption_end: float, scale: Scale = STANDARD) -> None:
        self._trace = trace
        self._pushes = trace.shown_pushes()
        self._view = view
        self._unit = view.height / LINES_OF_TEXT
        self._scale = scale
        width = caption_end - 1.5 * self._unit - OUTLINE["stroke_width"]
        characters = int(width / _font(0.85 * self._unit).getlength("0"))
        lines = [line for paragraph in caption.splitlines() for line in textwrap.wrap(paragraph, characters)]
        self._caption = lines[:MOST_LINES] + ["…"] * (len(lines) > MOST_LINES)

    def draw(self, picture: Image.Image, tick: int) -> None:
        """Draw over a frame.

        :param picture: frame of the view's size
        :param tick: row of the trace
        """
        pen = ImageDraw.Draw(picture)
        self._write(pen, tick)
        self._draw_phases(pen, tick)
        force = self._pushes[tick]
        if force is not None:
            self._draw_push(pen, tick, force)

    def _write(self, pen: ImageDraw.ImageDraw, tick: int) -> None:
        trace, unit = self._trace, self._unit
        phase, stance = str(trace.phase[tick]), Side(int(trace.stance[tick]))
        rows = [
            ("time", f"{trace.time[tick]:.2f} s", INK),
            ("phase", phase.upper(), INK),
            ("stance", f"{stance.name.lower()} leg", LEFT if stance is Side.LEFT else RIGHT),
            ("steps per second", f"{trace.steps_per_second[tick]:.1f}", INK),
            ("score so far", f"{trace.score[tick]:.2f}", INK),
        ]
        if math.isnan(trace.score[tick]):  # nobody knows it of a logged robot
            rows.pop()
        y = 1.5 * unit
        for label, value, colour in rows:
            pen.text((1.5 * unit, y), label, font=_font(0.85 * unit), fill=PALE_INK)
            pen.text((1.5 * unit, y + 1.0 * unit), value, font=_font(1.7 * unit, bold=True), fill=colour)
            y += 3.6 * unit
        size, bottom = _font(0.85 * unit), self._view.height - 1.2 * unit
        for line in reversed(self._caption):
            pen.text((1.5 * unit, bottom), line, font=size, fill=PALE_INK, anchor="ld", **OUTLINE)
            bottom -= 1.2 * unit

    def _draw_phases(self, pen: ImageDraw.ImageDraw, tick: int) -> None:
        """Draw the phases of the last seconds, each in the row of its swing leg, and the names of their colours."""
        trace, unit = self._trace, self._unit
        begin, end, top = 3.0 * unit, 16.5 * unit, 20.5 * unit
        rows = {side: top + 2.2 * unit * row for row, side in enumerate(Side)}
        for side, y in rows.items():
            colour = LEFT if side is Side.LEFT else RIGHT
            pen.text((1.5 * unit, y + 0.8 * unit), side.name[0], font=_font(unit, bold=True), fill=colour, anchor="lm")
            pen.rectangle((begin, y, end, y + 1.6 * unit), fill="#F1F3F5")
        places = end + (trace.time - trace.time[tick]) / STRIP_SECONDS * (end - begin)
        for past in range(trace.tick_at(trace.time[tick] - STRIP_SECONDS), tick):
            if trace.phase[past] in PHASE_COLOURS:  # a robot that fell while it stood never stepped
                y = rows[Side(int(trace.stance[past])).other]
                strip = (max(begin, places[past]), y, places[past + 1], y + 1.6 * unit)
                pen.rectangle(strip, fill=PHASE_COLOURS[trace.phase[past]])
        x, y = begin, top + 4.8 * unit
        for phase, colour in PHASE_COLOURS.items():
            pen.rectangle((x, y, x + 0.9 * unit, y + 0.9 * unit), fill=colour)
            pen.text((x + 1.2 * unit, y + 0.45 * unit), phase, font=_font(0.85 * unit), fill=PALE_INK, anchor="lm")
            x += 4.2 * unit
        note = f"swing leg, last {STRIP_SECONDS:g} s"
        pen.text((begin, y + 1.5 * unit), note, font=_font(0.85 * unit), fill=PALE_INK)

    def _draw_push(self, pen: ImageDraw.ImageDraw, tick: int, force: Vector) -> None:
        """Draw the push's arrow, and the force in newtons."""
        unit = self._unit
        ends = arrow(self._trace.position[tick], np.array(force), self._scale)
        draw_arrow(pen, self._view, ends)
        label = self._view.pixels(ends[:1] + self._scale.length * LABEL_OFFSET @ self._view.axes)[0]
        text = "\n".join(push_words(force))
        style: dict[str, Any] = {"font": _font(1.2 * unit, bold=True), "spacing": 0.3 * unit}
        left, top, right, bottom = pen.multiline_textbbox(tuple(label), text, **style)
        for low, high, axis, end in ((left, right, 0, self._view.width), (top, bottom, 1, self._view.height)):
            label[axis] += max(0.0, unit - low) - max(0.0, high + unit - end)  # it stays in the picture
        pen.multiline_text(tuple(label), text, fill=PUSH, **style, **OUTLINE)


@lru_cache(maxsize=16)
def _font(size: float, bold: bool = False) -> ImageFont.FreeTypeFont:
    """Font that comes with matplotlib, in a size in pixels."""
    import matplotlib

    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / name), round(size))
