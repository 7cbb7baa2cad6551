"""Shapes that the pictures of results share: lines, strips of dots, dots with intervals, one score against another."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from result_columns import heading
from result_rows import Row

from sarah.pictures.style import COLUMN_WIDTH

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Told apart by the colour-blind (Okabe and Ito)."""
WIDTH = 2 * COLUMN_WIDTH
LEGEND_CHARACTERS = 120
"""As many stand side by side in a legend."""
Rows = list[Row]


def grouped(rows: Iterable[Row], label: str) -> dict[str, Rows]:
    """Rows by what a template makes of them.

    :param rows: of a result
    :param label: template such as ``V1 = {V1}``
    """
    groups: dict[str, Rows] = {}
    for row in rows:
        groups.setdefault(label.format(**row), []).append(row)
    return groups


def numbers(rows: Iterable[Row], column: str) -> list[float]:
    """A column as numbers; where nothing was recorded there is no number.

    :param rows: of a result
    :param column: its name
    """
    return [float(row[column] or "nan") for row in rows]


def draw_lines(axis: Axes, rows: Rows, x: str, y: str, label: str, of_figure: Rows | None = None) -> None:
    """A line for each group, with its interval if there is one.

    :param axis: to draw on
    :param rows: of a result
    :param x: column
    :param y: column
    :param label: template that names the groups
    :param of_figure: rows of all panels, by which a group has the same colour in each; those of the panel by default
    """
    colours = dict(zip(grouped(of_figure or rows, label), COLOURS, strict=False))
    for name, group in grouped(rows, label).items():
        colour = colours[name]
        across = numbers(group, x)
        axis.plot(across, numbers(group, y), ".-", color=colour, linewidth=1.0, label=name)
        if f"{y}_low" in group[0]:
            ends = numbers(group, f"{y}_low"), numbers(group, f"{y}_high")
            axis.fill_between(across, *ends, color=colour, alpha=0.15, linewidth=0)
    axis.set(xlabel=heading(x), ylabel=heading(y))


def draw_strips(axis: Axes, columns: dict[str, list[float]], marks: dict[str, float], mark: str) -> None:
    """Every value as a dot, column beside column, and a value to compare with as a line.

    :param axis: to draw on
    :param columns: values by heading
    :param marks: values to compare with, by heading
    :param mark: what these are
    """
    for index, (name, values) in enumerate(columns.items()):
        axis.plot([index] * len(values), values, "o", color=COLOURS[0], alpha=0.5, markersize=4, markeredgewidth=0)
        if name in marks:
            line: dict[str, Any] = {"color": COLOURS[1], "linewidth": 1.5}
            axis.plot([index - 0.3, index + 0.3], [marks[name]] * 2, label=mark if index == 0 else None, **line)
    axis.set_xticks(range(len(columns)), list(columns))
    axis.set_xlim(-0.6, len(columns) - 0.4)
    axis.grid(visible=False, axis="x")


def draw_intervals(axis: Axes, labels: list[str], values: list[float], low: list[float], high: list[float]) -> None:
    """A dot with its interval for each label, from top to bottom.

    :param axis: to draw on
    :param labels: of the rows
    :param values: of the dots
    :param low: lower ends
    :param high: upper ends
    """
    heights = range(len(labels), 0, -1)
    axis.hlines(heights, low, high, color=COLOURS[0], linewidth=1.0)
    axis.plot(values, heights, "o", color=COLOURS[0], markersize=4)
    axis.set_yticks(heights, labels)
    axis.grid(visible=False, axis="y")


def draw_against(axis: Axes, rows: Rows, x: str, y: str, label: str) -> None:
    """One column against another, a colour for each group; equal values lie on the grey line.

    :param axis: to draw on
    :param rows: of results
    :param x: column
    :param y: column
    :param label: template that names the groups
    """
    axis.axline((0.0, 0.0), slope=1.0, color="grey", linewidth=0.8)
    for colour, (name, group) in zip(COLOURS, grouped(rows, label).items(), strict=False):
        axis.plot(numbers(group, x), numbers(group, y), "o", color=colour, markersize=4, alpha=0.7, label=name)
    axis.set(xlabel=heading(x), ylabel=heading(y), aspect="equal")


def panels(count: int, height: float = 0.45, **settings: Any) -> tuple[Figure, list[Axes]]:
    """Axes side by side, as wide as a page.

    :param count: how many
    :param height: height over width of the whole
    :param settings: of :func:`matplotlib.pyplot.subplots`
    """
    figure, axes = plt.subplots(
        1, count, squeeze=False, figsize=(WIDTH, height * WIDTH), layout="constrained", **settings
    )
    return figure, list(axes[0])


def legend(figure: Figure, axis: Axes) -> None:
    """One legend above everything.

    :param figure: of the axis
    :param axis: whose lines are named
    """
    handles, labels = axis.get_legend_handles_labels()
    columns = LEGEND_CHARACTERS // (max(map(len, labels)) + 6)
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), columns))
