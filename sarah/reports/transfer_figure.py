"""The figure of the transfer: the score in one physics engine against the score in the other."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from pathlib import Path

import matplotlib.pyplot as plt

from sarah.pictures.style import COLUMN_WIDTH, own_style, save
from sarah.reports.transfer import Transfer

ENGINE_COLOURS = {"pybullet": "#0072B2", "mujoco": "#D55E00"}
"""Colours of the engines, which colour-blind people can tell apart (Okabe and Ito)."""
TASK_MARKERS = "o^sDvP"
"""Markers of the tasks, in the order of the runs."""


def draw_transfer(transfers: Sequence[Transfer], path: Path) -> list[Path]:
    """Draw the score in one engine against the score in the other, with a point for each run.

    Equal scores lie on the line. Between the dotted lines the worse score is at least 90 % of the better.

    :param transfers: evaluations of the runs
    :param path: path of the picture, without suffix
    :return: the files, PNG and PDF
    """
    across, up = ENGINE_COLOURS
    with own_style():
        figure, axis = plt.subplots(figsize=(COLUMN_WIDTH, COLUMN_WIDTH), layout="constrained")
        axis.axline((0.0, 0.0), slope=1.0, color="grey", linewidth=0.8)
        for slope, label in ((0.9, "90 % kept"), (1.0 / 0.9, None)):
            axis.axline((0.0, 0.0), slope=slope, color="grey", linewidth=0.8, linestyle=":", label=label)
        names = dict.fromkeys(one.learned.task.name for one in transfers)
        markers = zip(names, itertools.cycle(TASK_MARKERS))
        for (engine, colour), (task, marker) in itertools.product(ENGINE_COLOURS.items(), markers):
            runs = [
                [one.evaluations[name].mean("score") for name in (across, up)]  # type: ignore[index]
                for one in transfers
                if (one.learned.config.engine, one.learned.task.name) == (engine, task)
            ]
            if runs:
                label = f"{task}, learned in {engine} ({len(runs)})"
                axis.plot(*zip(*runs, strict=True), marker, color=colour, markersize=4, alpha=0.8, label=label)
        lowest = min(min(e.mean("score") for e in one.evaluations.values()) for one in transfers)
        highest = max(max(e.mean("score") for e in one.evaluations.values()) for one in transfers)
        axis.set(xlim=(lowest - 0.05, highest + 0.05), ylim=(lowest - 0.05, highest + 0.05), aspect="equal")
        axis.set_xlabel(f"score in {across}")
        axis.set_ylabel(f"score in {up}")
        figure.legend(loc="outside upper center", ncols=1)
        return save(figure, path)
