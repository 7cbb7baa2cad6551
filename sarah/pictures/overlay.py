"""The text and symbols over a video's frames."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from sarah.episode.trace import Trace
from sarah.pictures.colours import LEFT, PHASE_COLOURS, PUSH, RIGHT
from sarah.robot.reading import Side
from sarah.simulation.scenery import View

INK, PALE_INK = "#1B1F24", "#5A6470"
METRES_PER_NEWTON = 0.005
"""Length of a push's arrow per force, in m/N."""
PUSH_SHOWN_SECONDS = 0.6
"""Time for which the arrow is shown, in s: the push itself is over before a viewer has noticed it."""
LABEL_OFFSET = np.array((0.26, 0.20, 0.0))
"""Position of the arrow's label from the torso's centre: to the right, upward and ahead in the picture, in m."""
DIRECTIONS = ("to its right", "forward", "to its left", "backward")
STRIP_SECONDS = 2.0
"""Length of the past that the strip of phases shows, in s."""


class Overlay:
    """Draws text and symbols over the frames of one episode.

    :param trace: trace of the episode
    :param view: view of the camera
    :param caption: text below the robot, one line or more
    """

    def __init__(self, trace: Trace, view: View, caption: str) -> None:
        self._trace = trace
        self._view = view
        self._caption = caption
        self._unit = view.height / 40
        forces = np.linalg.norm(trace.push, axis=1)
        self._push_tick = int(np.argmax(forces > 0.0)) if forces.any() else None

    def draw(self, picture: Image.Image, tick: int) -> None:
        """Draw over a frame.

        :param picture: frame of the view's size
        :param tick: row of the trace
        """
        pen = ImageDraw.Draw(picture)
        self._write(pen, tick)
        self._draw_phases(pen, tick)
        if self._push_tick is not None:
            since_push = self._trace.time[tick] - self._trace.time[self._push_tick]
            if 0.0 <= since_push < PUSH_SHOWN_SECONDS:
                self._draw_push(pen, tick, self._trace.push[self._push_tick])

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
        y = 1.5 * unit
        for label, value, colour in rows:
            pen.text((1.5 * unit, y), label, font=_font(0.85 * unit), fill=PALE_INK)
            pen.text((1.5 * unit, y + 1.0 * unit), value, font=_font(1.7 * unit, bold=True), fill=colour)
            y += 3.6 * unit
        size = _font(0.85 * unit)
        pen.text((1.5 * unit, self._view.height - 1.2 * unit), self._caption, font=size, fill=PALE_INK, anchor="ld")

    def _draw_phases(self, pen: ImageDraw.ImageDraw, tick: int) -> None:
        """Draw the phases of the last seconds, each in the row of its swing leg, and the names of their colours."""
        unit = self._unit
        begin, end, top = 3.0 * unit, 16.5 * unit, 20.5 * unit
        for row, side in enumerate(Side):
            y = top + 2.2 * unit * row
            colour = LEFT if side is Side.LEFT else RIGHT
            pen.text((1.5 * unit, y + 0.8 * unit), side.name[0], font=_font(unit, bold=True), fill=colour, anchor="lm")
            pen.rectangle((begin, y, end, y + 1.6 * unit), fill="#F1F3F5")
            for ages, phase, swing in self._past_phases(tick):
                if swing is side:
                    left, right = (end - age / STRIP_SECONDS * (end - begin) for age in ages)
                    pen.rectangle((left, y, right, y + 1.6 * unit), fill=PHASE_COLOURS[phase])
        x, y = begin, top + 4.8 * unit
        for phase, colour in PHASE_COLOURS.items():
            pen.rectangle((x, y, x + 0.9 * unit, y + 0.9 * unit), fill=colour)
            pen.text((x + 1.2 * unit, y + 0.45 * unit), phase, font=_font(0.85 * unit), fill=PALE_INK, anchor="lm")
            x += 4.2 * unit
        note = f"swing leg, last {STRIP_SECONDS:g} s"
        pen.text((begin, y + 1.5 * unit), note, font=_font(0.85 * unit), fill=PALE_INK)

    def _past_phases(self, tick: int) -> Iterator[tuple[tuple[float, float], str, Side]]:
        """Phases of the last seconds: how long ago each began and ended in s, its name, and its swing leg."""
        trace = self._trace
        now = trace.time[tick]
        rows = slice(trace.tick_at(now - STRIP_SECONDS), tick + 1)
        ages, phase, stance = now - trace.time[rows], trace.phase[rows], trace.stance[rows]
        changes = np.flatnonzero((phase[1:] != phase[:-1]) | (stance[1:] != stance[:-1])) + 1
        for begin, end in itertools.pairwise([0, *changes, len(ages) - 1]):
            began = min(STRIP_SECONDS, ages[begin])
            yield (began, ages[end]), str(phase[begin]), Side(int(stance[begin])).other

    def _draw_push(self, pen: ImageDraw.ImageDraw, tick: int, force: np.ndarray) -> None:
        """Draw an arrow that ends at the torso's centre, and the force in newtons."""
        unit = self._unit
        head = self._trace.position[tick]
        tail = head - METRES_PER_NEWTON * force
        tip, end = self._view.pixels(np.array((head, tail)))
        along = tip - end
        length = max(1.0, float(np.hypot(*along)))
        along = along / length
        across = np.array((-along[1], along[0]))
        neck = tip - min(1.6 * unit, 0.7 * length) * along
        pen.line((*end, *neck), fill=PUSH, width=round(0.6 * unit))
        pen.polygon([tuple(tip), tuple(neck + 0.9 * unit * across), tuple(neck - 0.9 * unit * across)], fill=PUSH)
        label = self._view.pixels(head + (LABEL_OFFSET @ self._view.axes)[None])[0]
        where = DIRECTIONS[round(math.atan2(force[1], force[0]) / (math.pi / 2)) % 4]
        text = f"push of {math.hypot(*force):.0f} N\n{where}"
        pen.multiline_text(tuple(label), text, font=_font(1.2 * unit, bold=True), fill=PUSH, spacing=0.3 * unit)


@lru_cache(maxsize=16)
def _font(size: float, bold: bool = False) -> ImageFont.FreeTypeFont:
    """Font that comes with matplotlib, in a size in pixels."""
    import matplotlib

    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    return ImageFont.truetype(str(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / name), round(size))
