"""Plots of an episode's signals over the same time, with a line at the shown time."""

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
"""Opacity of the shades behind the signals, as the last two digits of a colour."""
CHART_HEIGHT = 96
LOWEST_SHARE, HIGHEST_SHARE = 0.3, 99.7
"""Percentiles of a signal that its axis reaches to: the last moments of a fall would flatten everything else."""
WINDOWS = {"2 s": 2.0, "5 s": 5.0, "10 s": 10.0, "whole episode": np.inf}
"""Simulated time that the plots show at once, in s, by its label."""

Values = Callable[[Trace, Scenario], "np.ndarray | float"]


@dataclass(frozen=True)
class Line:
    """A line of a chart.

    :param label: label in the legend
    :param colour: colour of the line
    :param values: function that returns one value for each tick, or one value for all
    :param dashed: whether to draw it dashed, as a value that a signal is compared with
    """

    label: str
    colour: str
    values: Values
    dashed: bool = False


@dataclass(frozen=True)
class Chart:
    """A chart of one or more signals.

    :param axis: label of the axis, with the unit
    :param lines: lines of the chart
    :param smallest_span: smallest span of the axis, in its unit, so that noise does not look like motion
    """

    axis: str
    lines: tuple[Line, ...]
    smallest_span: float = 0.0


def _landing_rate(_: Trace, scenario: Scenario) -> float:
    return -scenario.config.controller.landing_rate * scenario.stepping[0]


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
            Line("P2: SHIFT ends above", UPPER, lambda _, scenario: scenario.stepping[1], dashed=True),
        ),
    ),
    Chart(
        "rate (rad/s)",
        (
            Line("rate", DARK, lambda trace, _: trace.rate),
            Line("0.01 P3: SHIFT ends above", UPPER, _least_rate, dashed=True),
            Line("-P1: LIFT ends below", LOWER, _landing_rate, dashed=True),
        ),
    ),
    Chart("pads (N)", _pads()),
    Chart(
        "leg (mm)",
        (
            Line("left leg retraction", LEFT, lambda trace, _: 1000.0 * trace.joints[:, 4]),
            Line("right leg retraction", RIGHT, lambda trace, _: 1000.0 * trace.joints[:, 5]),
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
            Line("steps per second, last 2 s", DARK, lambda trace, _: trace.steps_per_second),
            Line("best for the reward", GREY, lambda _, scenario: scenario.config.step_frequency, dashed=True),
        ),
        smallest_span=4.0,
    ),
)
"""Charts of the panel, from top to bottom."""

SHADES = {"lift": PHASE_COLOURS["lift"], "land": PHASE_COLOURS["land"], "push": PUSH}
"""Colours of the background during a phase of the pattern generator, and during a push. SHIFT is white."""
# uPlot draws each chart in an element of this class. So one rule moves the line in all charts, which is much faster
# than new data for each chart thirty times a second.
CURSOR_RULE = ".u-over::after {{left: {:.3f}%}}"
STYLE = f"""
.u-legend .u-series:nth-child(-n + {1 + len(SHADES)}) {{display: none}}
.u-over::after {{content: ''; position: absolute; top: 0; bottom: 0; border-left: 2px solid #d02090}}
.sarah-shades {{padding: 0 0.8em; font-size: 0.85em}}
.sarah-shades span {{padding: 0 0.5em; border-radius: 0.2em}}
"""


class Plots:
    """The charts, in a panel of their own.

    :param gui: user interface of the page
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
            self.charts = [_add_chart(gui, chart, chart is CHARTS[-1]) for chart in CHARTS]
        self._time = np.zeros(0)
        self._data: list[list[np.ndarray]] = []
        self._ranges: list[tuple[float, float]] = []
        self._page: slice | None = None

    def load(self, trace: Trace, scenario: Scenario) -> None:
        """Draw another episode.

        :param trace: trace of the episode
        :param scenario: scenario of the episode, whose parameters are drawn too
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
        """Move the line to a time, and show the window of time that contains it.

        :param time: simulated time, in s
        """
        begin, end = self._page_of(time)
        page = slice(int(np.searchsorted(self._time, begin - 1e-9)), int(np.searchsorted(self._time, end + 1e-9)))
        first, last = float(self._time[page.start]), float(self._time[page.stop - 1])
        if page != self._page:
            self._page = page
            for handle, data, span in zip(self.charts, self._data, self._ranges, strict=True):
                # Without these scales, the page would keep a chart's range of time from the data before.
                handle.scales = _scales((first, last), span)
                handle.data = tuple(values[page] for values in data)
        share = (time - first) / max(last - first, 1e-9)
        self._cursor.content = f"<style>{CURSOR_RULE.format(100.0 * min(max(share, 0.0), 1.0))}</style>"

    def _page_of(self, time: float) -> tuple[float, float]:
        """Window of time that contains a time; the last one ends with the episode, and may overlap the one before."""
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
        axes=(time_axis, uplot.Axis(label=chart.axis, labelSize=16, size=44, space=18)),  # shows two values at least
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
