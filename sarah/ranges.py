"""Ranges of settings, which stand in their types: ``duration: Annotated[float, Within(0.0, 10.0, "s")]``.

What is a range itself has its own in the same way: ``newtons: Annotated[tuple[float, float], Within(0.0, 1e4, "N")]``;
and each of several numbers: ``layers: tuple[Annotated[int, Within(1, 1000)], ...]``.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from typing import Annotated, Any, NamedTuple, get_args, get_origin, get_type_hints

from sarah.errors import check_ends, check_range, check_whole

Range = tuple[float, float]
"""Type of a setting that is a range: its ends, for which one number may stand."""


@dataclass(frozen=True)
class Within:
    """Range of a setting. Beyond it, somebody has mistaken the unit.

    :param low: lowest value
    :param high: highest value
    :param unit: unit of the value and of its limits
    """

    low: float
    high: float
    unit: str = ""

    @property
    def limits(self) -> tuple[float, float, str]:
        """Lowest value, highest value and unit, as the checks of :mod:`sarah.errors` take them."""
        return self.low, self.high, self.unit

    def __str__(self) -> str:
        """The range in words."""
        return f"{self.low:.10g} to {self.high:.10g} {self.unit}".rstrip()


def types_of(config_type: type) -> Mapping[str, Any]:
    """Types of the fields of a dataclass by name, without their ranges.

    :param config_type: the dataclass
    """
    return _read(config_type).types


def ranges_of(config_type: type) -> Mapping[str, Within]:
    """Ranges of the fields of a dataclass by name; a field without one is left out.

    :param config_type: the dataclass
    """
    return _read(config_type).ranges


def check_ranges(key: str, config: object) -> None:
    """Refuse settings of which one is not within its range, and make their numbers Python's own.

    :param key: beginning of the fields' names in messages
    :param config: settings to check while they are made, a frozen dataclass
    :raises ConfigurationError: naming key, value and range
    """
    annotated, ranges, _ = _read(type(config))  # type: ignore[arg-type]  # mypy takes classes for unhashable
    for name in ranges:
        object.__setattr__(config, name, _checked(f"{key}{name}", getattr(config, name), annotated[name]))


class _Hints(NamedTuple):
    annotated: dict[str, Any]
    ranges: dict[str, Within]
    types: dict[str, Any]


@cache
def _read(config_type: type) -> _Hints:
    """Types of the fields with and without their ranges, which take long to read: half a millisecond."""
    annotated = get_type_hints(config_type, include_extras=True)
    ranges = {name: within for name, kind in annotated.items() if (within := _range_in(kind))}
    return _Hints(annotated, ranges, get_type_hints(config_type))


def _range_in(kind: Any) -> Within | None:
    """Range of a type, or of the first of its parts that has one."""
    if isinstance(kind, Within):
        return kind
    return next(filter(None, map(_range_in, get_args(kind))), None)


def _checked(key: str, value: Any, kind: Any) -> Any:
    """A value within the range of its type; of a union, the first type has the range."""
    parts, within = get_args(kind), _range_in(kind)
    if within is None or (value is None and type(None) in parts):
        return value
    if get_origin(kind) is tuple:
        return tuple(_checked(key, item, parts[0]) for item in value)
    if get_origin(kind) is not Annotated:
        is_name = isinstance(value, str) and value in get_args(parts[1])
        return value if is_name else _checked(key, value, parts[0])
    if parts[0] == Range:
        return check_ends(key, value, *within.limits)
    check = check_whole if parts[0] is int else check_range
    return parts[0](check(key, value, *within.limits))
