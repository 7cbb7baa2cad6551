"""Plots of an episode's signals over the same time, with a line at the time that is shown."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import viser
from viser import uplot

from sarah.episode.trace import Trace
from sarah.pictures.colours import LEFT, PHASE_COLOURS, PUSH, RIGHT
from sarah.viewer.scenario import Scenario
from sarah.viewer.scene import PAD_COLOURS

DARK, GREY, UPPER, LOWER = "#282C34", "#999999", "#7A4FA3", "#B8860B"
SHADE = "60"
"""Opacity of what is behind the signals, as the last two digits of a colour."""
CHART_HEIGHT = 96
LOWEST_SHARE, HIGHEST_SHARE = 0.3, 99.7
"""Percentiles of a signal between which its axis reaches: the last moments of a fall would flatten all the rest."""
WINDOWS = {"2 s": 2.0, "5 s": 5.0, "10 s": 10.0, "whole episode": np.inf}
"""Simulated time that the plots show at once."""

Values = Callable[[Trace, Scenario], "np.ndarray | float"]


@dataclass(frozen=True)
class Line:
    """A line of a chart.

    :param label: of the legend
    :param colour: of the line
    :param values: one for each tick, or one for all
    :param dashed: for what a signal is compared with
    """

    label: str
    colour: str
    values: Values
    dashed: bool = False


@dataclass(frozen=True)
class Chart:
    """A chart.

    :param axis: name and unit
    :param lines: in it
    :param smallest_span: of the axis, so that noise does not look like motion
    """

    axis: str
    lines: tuple[Line, ...]
    smallest_span: float = 0.0


def _least_rate(_: Trace, scenario: Scenario) -> float:
    return scenario.config.controller.rate_scale * scenario.stepping[2]


def _pads() -> tuple[Line, ...]:
    names = ("left fore", "left hind", "right fore", "right hind")
    return tuple(
        Line(name, colour, lambda trace, _, pad=pad: trace.pressures[:, pad])  # type: ignore[misc]
        for pad, (name, colour) in enumerate(zip(names, PAD_COLOURS, strict=True))
    )


CHARTS = (
    Chart(
        "tilt (m/s²)",
        (
            Line("tilt", DARK, lambda trace, _: trace.tilt),
            Line("stable_x", GREY, lambda trace, _: trace.stable_x),
            Line("P2: may lift above", UPPER, lambda _, scenario: scenario.stepping[1], dashed=True),
        ),
    ),
    Chart(
        "rate (rad/s)",
        (
            Line("rate", DARK, lambda trace, _: trace.rate),
            Line("0.2 P3: may lift above", UPPER, _least_rate, dashed=True),
            Line("-P1: lands below", LOWER, lambda _, scenario: -scenario.stepping[0], dashed=True),
        ),
    ),
    Chart("pads (N)", _pads()),
    Chart(
        "leg (mm)",
        (
            Line("left leg, retracted", LEFT, lambda trace, _: 1000.0 * trace.joints[:, 4]),
            Line("right leg", RIGHT, lambda trace, _: 1000.0 * trace.joints[:, 5]),
        ),
    ),
    Chart(
        "hips (°)",
        (
            Line("abduction", DARK, lambda trace, _: np.degrees(trace.joints[:, 0])),
            Line("left flexion", LEFT, lambda trace, _: np.degrees(trace.joints[:, 2])),
            Line("right flexion", RIGHT, lambda trace, _: np.degrees(trace.joints[:, 3])),
        ),
        smallest_span=4.0,
    ),
    Chart(
        "steps/s",
        (
            Line("steps of the last 2 s, per second", DARK, lambda trace, _: trace.steps_per_second),
            Line("the reward's best", GREY, lambda *_: 3.0, dashed=True),
        ),
        smallest_span=4.0,
    ),
)
"""From top to bottom."""

SHADES = {"lift": PHASE_COLOURS["lift"], "land": PHASE_COLOURS["land"], "push": PUSH}
"""Of the background: while the pattern generator is in a phase, and while the robot is pushed. SHIFT is white."""
# What uPlot draws of a chart lies in an element of this class: one rule moves the line in all charts, where new data
# for each of them, thirty times a second, would be much.
CURSOR_RULE = ".u-over::after {{left: {:.3f}%}}"
STYLE = f"""
.u-legend .u-series:nth-child(-n + {1 + len(SHADES)}) {{display: none}}
.u-over::after {{content: ''; position: absolute; top: 0; bottom: 0; border-left: 2px solid #d02090}}
.sarah-shades {{padding: 0 0.8em; font-size: 0.85em}}
.sarah-shades span {{padding: 0 0.5em; border-radius: 0.2em}}
"""


class Plots:
    """The charts, in a panel of their own.

    :param gui: of the page
    """

    def __init__(self, gui: viser.GuiApi) -> None:
        panel = gui.add_panel()
        panel.dock_left()
        panel.set_width(470)
        with panel.add_tab("Signals"):
            shades = " ".join(
                f'<span style="background: {colour}{SHADE}">{name}</span>' for name, colour in SHADES.items()
            )
            gui.add_html(f"<style>{STYLE}</style><div class='sarah-shades'>Background: {shades}</div>")
            self._cursor = gui.add_html("")
            self.window = gui.add_dropdown("Show", tuple(WINDOWS), initial_value="5 s")
            self._charts = [_add_chart(gui, chart, chart is CHARTS[-1]) for chart in CHARTS]
        self._time = np.zeros(0)
        self._data: list[list[np.ndarray]] = []
        self._ranges: list[tuple[float, float]] = []
        self._page: slice | None = None

    def load(self, trace: Trace, scenario: Scenario) -> None:
        """Draw another episode.

        :param trace: of the episode
        :param scenario: with the parameters that are drawn in
        """
        self._time = trace.time
        is_pushed = trace.push.any(axis=1)
        shades = [(is_pushed if name == "push" else trace.phase == name).astype(float) for name in SHADES]
        self._data, self._ranges = [], []
        for chart in CHARTS:
            lines = [np.broadcast_to(line.values(trace, scenario), len(trace)) for line in chart.lines]
            self._ranges.append(_range(lines, chart.smallest_span))
            self._data.append([trace.time, *shades, *lines])
        self._page = None

    def show(self, time: float) -> None:
        """Move the line to a time, and turn to the page that it is on.

        :param time: simulated time in s
        """
        begin, end = self._page_of(time)
        page = slice(int(np.searchsorted(self._time, begin - 1e-9)), int(np.searchsorted(self._time, end + 1e-9)))
        first, last = float(self._time[page.start]), float(self._time[page.stop - 1])
        if page != self._page:
            self._page = page
            for handle, data, span in zip(self._charts, self._data, self._ranges, strict=True):
                # Left to itself, the page carries a chart's range of time over from other data.
                handle.scales = _scales((first, last), span)
                handle.data = tuple(values[page] for values in data)
        share = (time - first) / max(last - first, 1e-9)
        self._cursor.content = f"<style>{CURSOR_RULE.format(100.0 * min(max(share, 0.0), 1.0))}</style>"

    def _page_of(self, time: float) -> tuple[float, float]:
        """The window of time that a time is in; the last one ends with the episode, and may overlap the one before."""
        begin, end = float(self._time[0]), float(self._time[-1])
        window = WINDOWS[self.window.value]
        if end - begin <= window:
            return begin, end
        page_begin = min(begin + (time - begin) // window * window, end - window)
        return page_begin, page_begin + window


def _add_chart(gui: viser.GuiApi, chart: Chart, has_time_axis: bool) -> viser.GuiUplotHandle:
    shades = [
        uplot.Series(label=name, scale="shade", fill=colour + SHADE, width=0, points={"show": False})
        for name, colour in SHADES.items()
    ]
    lines = [
        uplot.Series(
            label=line.label,
            stroke=line.colour,
            width=1.5,
            points={"show": False},
            **({"dash": (6, 4)} if line.dashed else {}),
        )
        for line in chart.lines
    ]
    series = (uplot.Series(label="time (s)"), *shades, *lines)
    time_axis = uplot.Axis(size=36 if has_time_axis else 0, show=has_time_axis)
    if has_time_axis:
        time_axis |= uplot.Axis(label="time (s)", labelSize=14)
    return gui.add_uplot(
        tuple(np.array([0.0, 1.0]) for _ in series),
        series,
        scales=_scales((0.0, 1.0), (0.0, 1.0)),
        axes=(time_axis, uplot.Axis(label=chart.axis, labelSize=16, size=44, space=18)),  # two values at least
        cursor={"sync": {"key": "time"}, "drag": {"x": False, "y": False}},
        height=CHART_HEIGHT + (36 if has_time_axis else 0),
        padding=(6, 12, 2, 0),
    )


def _range(lines: list[np.ndarray], smallest_span: float) -> tuple[float, float]:
    low = min(float(np.percentile(values, LOWEST_SHARE)) for values in lines)
    high = max(float(np.percentile(values, HIGHEST_SHARE)) for values in lines)
    margin = max(0.05 * (high - low), (smallest_span - (high - low)) / 2)
    return low - margin, high + margin


def _scales(time: tuple[float, float], values: tuple[float, float]) -> dict[str, uplot.Scale]:
    return {"x": {"time": False, "range": time}, "y": {"range": values}, "shade": {"range": (0.0, 1.0)}}
