"""Tables and figures in sentences, as Markdown that reads as it lies."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pandas import DataFrame, Series

UNITS = {
    "mm": "mm",
    "cm": "cm",
    "s": "s",
    "n": "N",
    "kg": "kg",
    "hz": "Hz",
    "kb": "kB",
    "mib": "MiB",
    "m2_s4": "m²/s⁴",
}
"""Unit by the end of a column's name."""
WORDS = {
    "low": "from",
    "high": "to",
    "error": "±",
    "naf": "NAF",
    "td3": "TD3",
    "pybullet": "PyBullet",
    "mujoco": "MuJoCo",
    "v": "V",
}
"""Words of column names that are written otherwise."""
NOTHING = "\N{EN DASH}"
"""What stands in an empty cell."""


def table(rows: DataFrame, columns: Sequence[str], formats: Mapping[str, str], caption: str) -> str:
    """A table with a caption; each cell has one number or one text.

    :param rows: of a result
    :param columns: names of the columns, in order
    :param formats: format of the numbers by column; other columns are shown as they stand
    :param caption: sentence above the table
    """
    shown_columns = [[shown(value, formats.get(column, "")) for value in rows[column]] for column in columns]
    cells = list(zip(*shown_columns, strict=True))
    return "\n".join([f"**{caption}**", "", *markdown_table([heading(column) for column in columns], cells)])


def turned_table(
    rows: DataFrame, kept: Sequence[str], across: str | Sequence[str], column: str, spec: str, caption: str
) -> str:
    """A table of one column, whose values stand side by side.

    :param rows: of a result
    :param kept: columns that stay, which name the rows of the table
    :param across: columns whose values name the columns of the table
    :param column: column whose values are shown
    :param spec: format of these
    :param caption: sentence above the table
    """
    names = [across] if isinstance(across, str) else list(across)
    wide = rows.pivot(index=list(kept), columns=names, values=column)
    wide = wide.reindex(index=unique(rows, kept), columns=unique(rows, names))
    heads = [", ".join(map(str, name)) if isinstance(name, tuple) else str(name) for name in wide.columns]
    wide.columns = heads  # type: ignore[assignment]  # the stubs know an index only
    return table(wide.reset_index(), [*kept, *heads], dict.fromkeys(heads, spec), caption)


def unique(rows: DataFrame, columns: Sequence[str]) -> list[Any]:
    """Values of some columns, or of one, as they come first in the rows.

    :param rows: of a result
    :param columns: names of the columns
    """
    found = list(dict.fromkeys(rows[list(columns)].itertuples(index=False, name=None)))
    return found if len(columns) > 1 else [value for (value,) in found]


def markdown_table(head: Sequence[str], cells: Iterable[Sequence[str]]) -> list[str]:
    """Lines of a table.

    :param head: its head
    :param cells: its cells, row by row
    """
    return [f"| {' | '.join(cell or NOTHING for cell in line)} |" for line in (head, ["---"] * len(head), *cells)]


def heading(column: str) -> str:
    """What stands over a column: its name in words, with the unit.

    :param column: name of the column
    """
    unit = next((unit for unit in UNITS if column.endswith(f"_{unit}")), "")
    words = column.removesuffix(f"_{unit}").split("_")
    if words[-1] in ("low", "high", "error"):
        words = words[-1:]
    text = " ".join(WORDS.get(word, word) for word in words)
    return f"{text} ({UNITS[unit]})" if unit else text


def shown(value: Any, spec: str = "") -> str:
    """A value for people: with a minus sign, and a space before the percent sign.

    :param value: number or text; no number is shown by a dash
    :param spec: format of a number
    """
    if value is None or value != value:  # only what is no number differs from itself
        return NOTHING
    if value == float("inf"):
        return "not reached"
    if isinstance(value, str) or not spec:
        return str(value)
    return re.sub("^-", "\N{MINUS SIGN}", format(value, spec)).replace("%", "\N{NO-BREAK SPACE}%")


def span(values: Series[Any], spec: str) -> str:
    """The lowest and the highest of some values, as words.

    :param values: of a column
    :param spec: format of a number
    """
    low, high = shown(values.min(), spec), shown(values.max(), spec)
    return high if low == high else f"{low.removesuffix(chr(0xA0) + '%')} to {high}"
