"""The figure of the ground that the robot copes with."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from sarah.episode.evaluation import Evaluation
from sarah.pictures.style import COLUMN_WIDTH, own_style, save
from sarah.reports.robustness import wilson_interval
from sarah.reports.terrain import UPHILL, Situation

KINDS = {"slope": ("slope (°)", 1.0), "roughness": ("bumps (mm)", 1000.0), "friction": ("friction", 1.0)}
"""Label of each kind of ground, and factor from its value to the label's unit."""
ROWS = {
    "score": "score",
    "steps_per_second": "steps per second",
    "shifts_by_sensors": "SHIFT by sensors",
    "survival": "survival",
}
"""Labels of what is shown, from top to bottom."""
UPHILL_COLOURS = dict(zip(UPHILL, ("#D55E00", "#009E73", "#0072B2", "#CC79A7"), strict=True))
"""Colours of the directions that lead uphill (Okabe and Ito): right and left are those of the legs."""
OTHER_COLOUR = "#000000"


def draw_terrain(evaluations: Mapping[Situation, Evaluation], path: Path) -> list[Path]:
    """Draw score, steps, phases that sensors end, and survival over slope, bumps and friction.

    Dashed lines are with the push. Survival has its 95 % intervals.

    :param evaluations: evaluations in situations
    :param path: path of the picture, without suffix
    :return: the files, PNG and PDF
    """
    with own_style():
        size = (2 * COLUMN_WIDTH, 2.4 * COLUMN_WIDTH)
        figure, axes = plt.subplots(
            len(ROWS), len(KINDS), sharex="col", sharey="row", figsize=size, layout="constrained"
        )
        for column, (kind, (label, factor)) in enumerate(KINDS.items()):
            for axis, (metric, metric_label) in zip(axes[:, column], ROWS.items(), strict=True):
                _draw(axis, {s: e for s, e in evaluations.items() if _belongs(s, kind)}, metric, factor)
                if column == 0:
                    axis.set_ylabel(metric_label)
            axes[-1, column].set_xlabel(label)
        for axis in axes[:, 0]:  # once all columns, which share it, are drawn
            axis.set_ylim(bottom=0.0)
        handles, labels = (
            [one for axis in axes[0, :2] for one in axis.get_legend_handles_labels()[part]] for part in (0, 1)
        )
        figure.legend(handles, labels, loc="outside upper center", ncols=3)
        return save(figure, path)


def _belongs(situation: Situation, kind: str) -> bool:
    """Whether a situation is of a kind; level ground has no bumps, too."""
    return situation.kind == kind or (kind == "roughness" and situation.kind == "slope" and situation.value == 0.0)


def _draw(axis: Axes, evaluations: Mapping[Situation, Evaluation], metric: str, factor: float) -> None:
    """Draw a line for each direction that leads uphill, where there are any, without the push and with it."""
    directions = [name for name in dict.fromkeys(situation.uphill for situation in evaluations) if name]
    for newtons in dict.fromkeys(situation.newtons for situation in evaluations):
        for uphill in directions or [""]:
            line = {s: e for s, e in evaluations.items() if s.newtons == newtons and s.uphill in ("", uphill)}
            x = [factor * situation.value for situation in line]
            found = [e.survival_rate if metric == "survival" else e.mean(metric) for e in line.values()]
            colour, dashes = UPHILL_COLOURS.get(uphill, OTHER_COLOUR), "--" if newtons else "-"
            pushed = f", {newtons:.0f} N" if newtons else ""
            label = f"uphill {uphill}{pushed}" if uphill else f"bumps or friction{pushed}"
            axis.plot(x, found, dashes, marker="o", markersize=2.5, linewidth=1.0, color=colour, label=label)
            if metric == "survival":
                low, high = zip(*(wilson_interval(e.survivors, e.episodes) for e in line.values()), strict=True)
                axis.fill_between(x, low, high, color=colour, alpha=0.08, linewidth=0.0)
