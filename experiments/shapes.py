"""Shapes that pictures of results share: lines and strips of dots."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pandas import DataFrame, Series

from experiments.tables import heading, unique
from sarah.pictures.style import COLUMN_WIDTH

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
"""Told apart by the colour-blind (Okabe and Ito)."""
WIDTH = 2 * COLUMN_WIDTH
LEGEND_CHARACTERS = 120
"""As many stand side by side in a legend."""


def groups(rows: DataFrame, *columns: str) -> dict[Any, DataFrame]:
    """Rows by the values of some columns, in the order in which these come first."""
    return dict(tuple(rows.groupby(columns[0] if len(columns) == 1 else list(columns), sort=False)))


def lines(axis: Axes, rows: DataFrame, x: str, y: str, label: str, of_figure: DataFrame | None = None) -> None:
    """A line for each group that the column ``label`` names, with its interval if there is one.

    :param of_figure: rows of all panels, by which a group has the same colour in each; those of the panel by default
    """
    colours = dict(zip(unique(rows if of_figure is None else of_figure, [label]), COLOURS, strict=False))
    for name, group in groups(rows, label).items():
        axis.plot(group[x], group[y], ".-", color=colours[name], linewidth=1.0, label=str(name))
        if f"{y}_low" in group:
            ends = group[f"{y}_low"], group[f"{y}_high"]
            axis.fill_between(group[x], *ends, color=colours[name], alpha=0.15, linewidth=0)
    axis.set(xlabel=heading(x), ylabel=heading(y))


def line_panels(
    rows: DataFrame, panel: str, x: str, y: str, label: str, height: float = 0.35, **settings: Any
) -> Figure:
    """Panels side by side with :func:`lines`, a colour for the same label in all.

    :param panel: column that names the panels
    """
    parts = groups(rows, panel)
    figure, axes = panels(len(parts), height, **settings)
    for axis, (name, part) in zip(axes, parts.items(), strict=True):
        lines(axis, part, x, y, label, of_figure=rows)
        axis.set_title(str(name), fontsize="small")
        axis.set_ylabel(heading(y) if axis is axes[0] else "")
    legend(figure, axes[0])
    return figure


def strips(
    axis: Axes, columns: Mapping[str, Series[Any]], marks: Mapping[str, float] | None = None, mark: str = ""
) -> None:
    """Every value as a dot, column beside column, and a mark to compare with as a line, by heading."""
    for index, (name, values) in enumerate(columns.items()):
        axis.plot([index] * len(values), values, "o", color=COLOURS[0], alpha=0.5, markersize=4, markeredgewidth=0)
        if marks and name in marks:
            line: dict[str, Any] = {"color": COLOURS[1], "linewidth": 1.5}
            axis.plot([index - 0.3, index + 0.3], [marks[name]] * 2, label=mark if index == 0 else None, **line)
    axis.set_xticks(range(len(columns)), list(columns))
    axis.set_xlim(-0.6, len(columns) - 0.4)
    axis.grid(visible=False, axis="x")


def panels(count: int, height: float = 0.45, **settings: Any) -> tuple[Figure, list[Axes]]:
    """Axes side by side, as wide as a page.

    :param height: height over width of the whole
    :param settings: arguments of :func:`matplotlib.pyplot.subplots`
    """
    size = (WIDTH, height * WIDTH)
    figure, axes = plt.subplots(1, count, squeeze=False, figsize=size, layout="constrained", **settings)
    return figure, list(axes[0])


def legend(figure: Figure, axis: Axes) -> None:
    """One legend above everything."""
    handles, labels = axis.get_legend_handles_labels()
    columns = LEGEND_CHARACTERS // (max(map(len, labels)) + 6)
    figure.legend(handles, labels, loc="outside upper center", ncols=min(len(labels), columns))
