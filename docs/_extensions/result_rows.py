"""Choosing and summing up the rows of a result: what tables, pictures and sentences of the pages have in common."""

from __future__ import annotations

import operator
import re
from collections.abc import Callable, Iterable, Sequence
from fnmatch import fnmatchcase
from statistics import mean, median

from result_columns import format_of, most_decimals, shown, typeset, with_decimals

from experiments import record

Row = dict[str, str]
CONDITION = re.compile(r"(\w+)\s*(<=|>=|!=|<|>|=)\s*(.*)")
COMPARISONS = {"<=": operator.le, ">=": operator.ge, "<": operator.lt, ">": operator.gt}
SUMMARIES: dict[str, Callable[[Sequence[float]], float]] = {"median": median, "mean": mean, "min": min, "max": max}
SENTENCE = re.compile(r"(\w+) (\w+)(?:\.(\w+))?(?: where (.+?))?(?: as (\S+))?")


def chosen(rows: Iterable[Row], where: str) -> list[Row]:
    """Rows that meet all conditions.

    :param rows: of a result
    :param where: conditions as ``column=pattern`` or ``column>=number``, joined by ``and``; none if empty
    """
    conditions = [condition.strip() for condition in where.split(" and ")] if where else []
    return [row for row in rows if all(_meets(row, condition) for condition in conditions)]


def _meets(row: Row, condition: str) -> bool:
    found = CONDITION.fullmatch(condition)
    if not found or found[1] not in row:
        raise ValueError(f"{condition!r} is no condition on the columns {', '.join(row)}")
    column, comparison, value = found.groups()
    if comparison in COMPARISONS:
        return row[column] != "" and bool(COMPARISONS[comparison](float(row[column]), float(value)))
    return fnmatchcase(row[column], value) == (comparison == "=")


def figure(sentence: str) -> str:
    """One figure for a sentence of a page, such as ``median first_training.score where run=naf* as .2f``.

    :param sentence: a function (``value`` of a single row, ``median``, ``mean``, ``min``, ``max``, ``range``, or
        ``count`` of the rows), the result and its column, conditions, and a format
    """
    found = SENTENCE.fullmatch(sentence)
    if not found:
        raise ValueError(f"{sentence!r} is not FUNCTION RESULT.COLUMN where CONDITIONS as FORMAT")
    function, name, column, where, spec = found.groups()
    rows = chosen(record.read(name).rows, where or "")
    if function == "count":
        return str(len(rows))
    if not rows or column not in rows[0]:
        raise ValueError(f"{sentence!r} finds nothing: no such rows or no column {column!r}")
    texts = [row[column] for row in rows if row[column]]
    if function == "value":
        if len(rows) != 1:
            raise ValueError(f"{sentence!r} finds {len(rows)} rows instead of one")
        return typeset(format(float(texts[0]), spec)) if spec else shown(column, texts[0], texts)
    numbers = [float(text) for text in texts]
    spec = spec or with_decimals(format_of(column), most_decimals(texts))
    if function == "range":
        low, high = (typeset(format(end, spec)) for end in (min(numbers), max(numbers)))
        return high if low == high else f"{without_percent(low, high)} to {high}"
    if function not in SUMMARIES:
        raise ValueError(f"{sentence!r} begins with none of value, count, range, {', '.join(SUMMARIES)}")
    return typeset(format(SUMMARIES[function](numbers), spec))


def without_percent(first: str, second: str) -> str:
    """The first of two numbers without its percent sign, if the second says it.

    :param first: of the numbers
    :param second: of the numbers
    """
    sign = "\N{NO-BREAK SPACE}%"
    return first.removesuffix(sign) if second.endswith(sign) else first
