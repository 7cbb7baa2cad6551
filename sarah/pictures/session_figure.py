"""The figure of a session: score over the time of operation, with falls and changes."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import yaml
from scipy.ndimage import uniform_filter1d

from sarah.operation.settings import Change
from sarah.operation.window import Window
from sarah.pictures.style import COLUMN_WIDTH, own_style, save

SCORE, OBSERVED, FALL, FROZEN = "#0072B2", "#E69F00", "#D55E00", "#009E73"
"""Colours (Okabe and Ito)."""
WIDEST_LINE, MOST_LINES = 130, 12
"""Largest numbers of characters of a line, and of lines, that tell the changes."""
SMOOTHED = 5
"""Number of windows whose mean the line shows."""


def draw_session(
    windows: Sequence[Window], changes: Sequence[Change], path: Path, frozen: Sequence[Window] = ()
) -> list[Path]:
    """Draw every window as a point, their running mean as a line, falls as crosses and changes as numbered lines.

    Of a robot without true scores, it is the rewards that the robot itself observed.

    :param windows: windows of the session, at least one
    :param changes: what was to change in its course; what no window began after is not drawn
    :param path: path of the picture, without suffix
    :param frozen: windows of the same session without learning, whose running mean is another line, if there are any
    :return: the files, PNG and PDF
    """
    minutes = [window.end / 60.0 for window in windows]
    scores, has_scores = [window.worth for window in windows], all(window.score is not None for window in windows)
    falls = [index for index, window in enumerate(windows) if window.fell]
    with own_style():
        figure, axis = plt.subplots(figsize=(2 * COLUMN_WIDTH, COLUMN_WIDTH), layout="constrained")
        axis.plot(minutes, scores, ".", color=SCORE, markersize=3, alpha=0.5, label="window")
        if has_scores:
            observed = [window.observed_reward for window in windows]
            axis.plot(
                minutes, _running_mean(observed), color=OBSERVED, linewidth=0.8, label="what the robot itself observes"
            )
        axis.plot(minutes, _running_mean(scores), color=SCORE, linewidth=1.5, label=f"mean of {SMOOTHED} windows")
        if frozen:
            ends, means = [window.end / 60.0 for window in frozen], _running_mean([window.worth for window in frozen])
            axis.plot(ends, means, color=FROZEN, label=f"mean of {SMOOTHED} without learning")
        if falls:
            axis.plot([minutes[i] for i in falls], [scores[i] for i in falls], "x", color=FALL, label="fall")
        made = changes[: windows[-1].changes]
        for number, change in enumerate(made, 1):
            axis.axvline(change.minute, color="black", linestyle="--", linewidth=0.8)
            axis.annotate(
                f"{number}", (change.minute, 1.02), (0, 1), textcoords="offset points", fontsize=6, ha="center"
            )
        lines = [line for number, change in enumerate(made, 1) for line in _lines(number, change)]
        lines = lines[:MOST_LINES] + ["…"] * (len(lines) > MOST_LINES)
        if lines:
            axis.set_title("\n".join(lines), loc="left", fontsize=6, pad=9)
        axis.set(
            xlabel="time of operation (min)", ylabel="score" if has_scores else "observed reward", ylim=(0.0, 1.02)
        )
        axis.legend(loc="lower right", ncols=2)
        return save(figure, path)


def _lines(number: int, change: Change) -> list[str]:
    """A change in words, as in a YAML file."""
    words = yaml.safe_dump(dict(change.settings), default_flow_style=True, sort_keys=False).strip()[1:-1]
    return textwrap.wrap(f"{number}: {words}", WIDEST_LINE, subsequent_indent="    ")


def _running_mean(values: Sequence[float]) -> np.ndarray:
    """Mean of each value and those before it."""
    return np.asarray(uniform_filter1d(values, SMOOTHED, mode="nearest", origin=SMOOTHED // 2))
