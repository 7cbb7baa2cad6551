"""What a metric is: a field of a dataclass, beside the code that measures it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any


@dataclass(frozen=True)
class Metric:
    """A metric: a number that describes an episode.

    :param label: name on pages and in tables
    :param unit: SI unit; empty for a number without one
    :param meaning: quantity that it measures, as a noun phrase
    :param statistics: statistics of several episodes that are shown, the most telling one first; names of
        :data:`~sarah.episode.evaluation.STATISTICS`
    :param group: group of its learning curve; empty if it has none
    :param shown: display format: factor on the SI value, number of decimals, and unit after the factor
    :param paper: value or remark that the paper gives
    """

    label: str
    unit: str
    meaning: str
    statistics: tuple[str, ...] = ()
    group: str = ""
    shown: tuple[float, int, str] = (1.0, 2, "")
    paper: str = ""

    def text(self, value: float) -> str:
        """Text of a value with its unit, for people.

        :param value: value in the SI unit
        """
        factor, decimals, unit = self.shown
        return f"{factor * value:.{decimals}f} {unit}".rstrip()


def metric(label: str, unit: str, meaning: str, *statistics: str, **others: Any) -> Any:
    """Field of a dataclass that is a metric; the arguments are those of :class:`Metric`."""
    return field(metadata={"metric": Metric(label, unit, meaning, statistics, **others)})
