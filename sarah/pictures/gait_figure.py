"""One gait cycle as time plots: sensor signals, the parameters they are compared with, and the motion of the legs."""

from __future__ import annotations

import itertools
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Patch

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.pattern_generator import Phase, SteppingParameters
from sarah.episode.trace import Trace
from sarah.errors import ConfigurationError
from sarah.pictures.colours import LEFT, PHASE_COLOURS, RIGHT
from sarah.pictures.style import COLUMN_WIDTH, own_style, save, times

THRESHOLD = "#A51417"
MEDIANS_SHOWN = 3.0
"""Upper end of the axis of loads, in medians of their sum: the impact of a landing exceeds it by far."""
AFTER_SECONDS = 8.0
"""Simulated time after which a cycle is chosen, in s: by then the gait has settled."""


def gait_cycle(trace: Trace) -> slice:
    """Find one gait cycle, a step with each leg, after the gait has settled; in a short episode, the last cycle.

    :param trace: trace of an episode
    :return: rows of the trace, from the beginning of a SHIFT with the right leg as stance leg to the next such SHIFT
    :raises ConfigurationError: if the robot completed no cycle
    """
    begins = (trace.phase == Phase.SHIFT.value) & (trace.stance == 1)
    begins[1:] &= ~begins[:-1]
    cycles = list(itertools.pairwise(np.flatnonzero(begins)))[1:]  # the first cycle begins the gait
    if not cycles:
        raise ConfigurationError("the robot completes no cycle")
    begin, end = next((cycle for cycle in cycles if trace.time[cycle[0]] >= AFTER_SECONDS), cycles[-1])
    return slice(int(begin), int(end) + 1)


def draw_gait_cycle(
    trace: Trace, parameters: SteppingParameters, path: Path, constants: ControllerConstants = STANDARD_CONSTANTS
) -> list[Path]:
    """Draw one gait cycle, with the parameters that end its phases.

    :param trace: trace of an episode
    :param parameters: values of P1 to P5 in that episode
    :param path: path of the picture, without suffix
    :param constants: constants of the controller in that episode
    :return: the files, PNG and PDF
    :raises ConfigurationError: if the robot completed no cycle; nothing is drawn then
    """
    rows = gait_cycle(trace)
    time, stance = trace.time[rows], trace.stance[rows]
    has_hips = bool(np.any(trace.targets[:, :4]))
    with own_style({"axes.grid": False, "legend.fontsize": 6.5}):
        count = 5 if has_hips else 4
        figure, axes = plt.subplots(
            count, 1, sharex=True, figsize=(COLUMN_WIDTH, 0.7 + 1.05 * count), layout="constrained"
        )
        tilt, rate, load, length = axes[:4]
        tilt.plot(time, trace.tilt[rows], color="black", linewidth=1.2)
        _threshold(tilt, time, trace.phase[rows] == "shift", parameters.P2, "P2")
        tilt.set_ylabel("tilt\n(m/s²)")
        rate.plot(time, trace.rate[rows], color="black", linewidth=1.2)
        landing, scale = constants.landing_rate, constants.rate_scale
        _threshold(rate, time, trace.phase[rows] == "lift", -landing * parameters.P1, times(-landing, "P1"), "top")
        _threshold(rate, time, trace.phase[rows] == "shift", scale * parameters.P3, times(scale, "P3"), "bottom")
        rate.set_ylabel("rate\n(rad/s)")
        pads = trace.pressures[rows]
        _both(load, time, pads[:, :2].sum(axis=1), pads[:, 2:].sum(axis=1))
        load.set_ylim(0.0, MEDIANS_SHOWN * float(np.median(pads.sum(axis=1))))
        load.set_ylabel("pad load\n(N)")
        joints = trace.joints[rows]
        _both(length, time, 1000 * joints[:, 4], 1000 * joints[:, 5])
        length.set_ylabel("leg\nretraction\n(mm)")
        if has_hips:
            abduction, left, right = np.degrees((joints[:, :2].mean(axis=1), joints[:, 2], joints[:, 3]))
            # The left one is wider: where both hips are flexed alike it would hide under the right one
            axes[4].plot(time, left, color=LEFT, linewidth=2.4, label="flexion, left")
            axes[4].plot(time, right, color=RIGHT, linewidth=1.2, label="flexion, right")
            axes[4].plot(time, abduction, color="black", linewidth=1.0, label="abduction of both")
            axes[4].set_ylabel("hip angle\n(degrees)")
            axes[4].legend(loc="best")
        axes[-1].set_xlabel("time (s)")
        axes[-1].set_xlim(time[0], time[-1])
        for axis in axes:
            _shade(axis, time, trace.phase[rows])
        change = time[np.flatnonzero(np.diff(stance))[0] + 1]
        for begin, end, leg in ((time[0], change, "left"), (change, time[-1], "right")):
            tilt.text((begin + end) / 2, 1.02, f"{leg} leg swings", ha="center", transform=tilt.get_xaxis_transform())
        patches = [Patch(color=colour, label=name.upper()) for name, colour in PHASE_COLOURS.items()]
        lines = [plt.Line2D([], [], color=colour, label=label) for colour, label in ((LEFT, "left"), (RIGHT, "right"))]
        figure.legend(
            handles=[*patches, *lines], loc="outside upper center", ncols=5, columnspacing=1.0, handlelength=1.2
        )
        figure.align_ylabels()
        return save(figure, path)


def _both(axis: Axes, time: np.ndarray, left: np.ndarray, right: np.ndarray) -> None:
    axis.plot(time, left, color=LEFT, linewidth=1.2)
    axis.plot(time, right, color=RIGHT, linewidth=1.2)


def _threshold(axis: Axes, time: np.ndarray, counts: np.ndarray, value: float, name: str, side: str = "center") -> None:
    """Draw a parameter while it is compared, with its name on one side of it, as two may be close together."""
    axis.plot(time, np.where(counts, value, np.nan), color=THRESHOLD, linewidth=1.2, linestyle=(0, (2, 1)))
    axis.annotate(
        name,
        (1.0, value),
        (2, 0),
        xycoords=axis.get_yaxis_transform(),
        textcoords="offset points",
        va=side,
        color=THRESHOLD,
        fontsize=7,
    )


def _shade(axis: Axes, time: np.ndarray, phases: np.ndarray) -> None:
    changes = [0, *(np.flatnonzero(phases[1:] != phases[:-1]) + 1), len(phases) - 1]
    for begin, end in itertools.pairwise(changes):
        axis.axvspan(time[begin], time[end], color=PHASE_COLOURS[phases[begin]], alpha=0.45, linewidth=0)
