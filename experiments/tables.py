"""Tables and figures in sentences, as Markdown that reads as it lies."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from pandas import DataFrame, Series

UNITS = {
    **{unit.lower(): unit for unit in ("mm", "cm", "s", "N", "kg", "Hz", "kB", "MiB")},
    "m2_s4": "m²/s⁴",
}
"""Unit by the end of a column's name."""
WORDS = {
    **{word.lower(): word for word in ("NAF", "TD3", "PyBullet", "MuJoCo", "V")},
    **{"low": "from", "high": "to", "error": "±"},
}
"""Words of column names that are written otherwise."""
FORMATS = {
    **dict.fromkeys(("P1", "P2", "P3", "P4", "P5", "V1", "V2", "V3", "V4", "steps_per_second"), ".2f"),
    **dict.fromkeys(("survival", "by_sensors", "kept"), ".0%"),
    **dict.fromkeys(("_n", "_mm", "_kb", "_mib"), ".0f"),
    "score": ".3f",
    "difference": "+.1%",
    "_cm": ".1f",
}
"""Format of numbers by the end of a column's name; that of their intervals and errors is the same."""
NOTHING = "\N{EN DASH}"
"""What stands in an empty cell."""


def table(rows: DataFrame, columns: Sequence[str], caption: str, **formats: str) -> str:
    """A table with a caption; each cell has one number or one text.

    :param formats: formats by the end of a column's name, beside those of :data:`FORMATS`
    """
    specs = {column: format_of(column, formats) for column in columns}
    shown_columns = [[shown(value, spec) for value in rows[column]] for column, spec in specs.items()]
    cells = list(zip(*shown_columns, strict=True))
    return "\n".join([f"**{caption}**", "", *markdown_table([heading(column) for column in columns], cells)])


def turned_table(
    rows: DataFrame, kept: Sequence[str], across: str | Sequence[str], column: str, caption: str, spec: str = ""
) -> str:
    """A table of one column, whose values stand side by side.

    :param kept: columns that stay, which name the rows of the table
    :param across: columns whose values name the columns of the table
    :param column: column whose values are shown
    :param spec: format of the values; by default that of the column
    """
    names = [across] if isinstance(across, str) else list(across)
    wide = rows.pivot(index=list(kept), columns=names, values=column)
    wide = wide.reindex(index=unique(rows, kept), columns=unique(rows, names))
    heads = [", ".join(map(str, name)) if isinstance(name, tuple) else str(name) for name in wide.columns]
    wide.columns = heads
    return table(wide.reset_index(), [*kept, *heads], caption, **dict.fromkeys(heads, spec or format_of(column)))


def format_of(column: str, formats: Mapping[str, str] = FORMATS) -> str:
    """Format of a column's numbers; none if they are shown as they stand."""
    name = re.sub("_(low|high|error)$", "", column)
    known = [*formats.items(), *FORMATS.items()]
    return next((spec for end, spec in known if column.endswith(end) or name.endswith(end)), "")


def unique(rows: DataFrame, columns: Sequence[str]) -> list[Any]:
    """Values of some columns, or of one, as they come first in the rows."""
    found = list(dict.fromkeys(rows[list(columns)].itertuples(index=False, name=None)))
    return found if len(columns) > 1 else [value for (value,) in found]


def markdown_table(head: Sequence[str], cells: Iterable[Sequence[str]]) -> list[str]:
    """Lines of a table."""
    return [f"| {' | '.join(cell or NOTHING for cell in line)} |" for line in (head, ["---"] * len(head), *cells)]


def heading(column: str) -> str:
    """What stands over a column: its name in words, with the unit."""
    unit = next((unit for unit in UNITS if column.endswith(f"_{unit}")), "")
    words = column.removesuffix(f"_{unit}").split("_")
    if words[-1] in ("low", "high", "error"):
        words = words[-1:]
    text = " ".join(WORDS.get(word, word) for word in words)
    return f"{text} ({UNITS[unit]})" if unit else text


def shown(value: Any, spec: str = "") -> str:
    """A value for people: with a minus sign, and a space before the percent sign."""
    if value is None or value != value:  # only what is no number differs from itself
        return NOTHING
    if value == float("inf"):
        return "not reached"
    if isinstance(value, str) or not spec:
        return str(value)
    return re.sub("^-", "\N{MINUS SIGN}", format(value, spec)).replace("%", "\N{NO-BREAK SPACE}%")


def share_of(count: int, total: int, what: str) -> str:
    """How many of some things, in words: ``all 10 trainings``, or ``8 of 10 trainings``."""
    return f"all {total} {what}" if count == total else f"{count} of {total} {what}"


def survived_pushes(shares: Iterable[float], newtons: float) -> str:
    """Which pushes are survived, in words: ``every push of 100 N``, or ``85 to 86 % of pushes of 100 N``.

    :param shares: lowest and highest share of the pushes that are survived, or shares in between too
    """
    found = Series(list(shares))
    if found.min() == 1.0:
        return f"every push of {newtons:.0f} N"
    return f"{span(found, '.0%')} of pushes of {newtons:.0f} N"


def so_far(made: int, planned: int) -> str:
    """How many of some seeds, in words while some are still to be made: ``5``, or ``3 of 5 so far``."""
    return str(made) if made == planned else f"{made} of {planned} so far"


def span(values: Series[Any], spec: str) -> str:
    """The lowest and the highest of some values, as words."""
    low, high = shown(values.min(), spec), shown(values.max(), spec)
    return high if low == high else f"{low.removesuffix(chr(0xA0) + '%')} to {high}"
