"""Ranges of settings, which stand in their types: ``duration: Annotated[float, Within(0.0, 10.0, "s")]``.

A setting that is a range itself has limits in the same way:
``newtons: Annotated[tuple[float, float], Within(0.0, 1e4, "N")]``. So has each of several numbers:
``layers: tuple[Annotated[int, Within(1, 1000)], ...]``.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, is_dataclass
from functools import cache, partial
from types import NoneType
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, get_args, get_origin, get_type_hints

from sarah.errors import ConfigurationError, check_ends, check_range, check_type, check_whole, unknown_name
from sarah.number import plain

if TYPE_CHECKING:

    class Range:
        """Type of a setting that is a range, for type checkers: it is given as ends or as one number, and has ends."""

        def __init__(self, ends: tuple[float, float]) -> None: ...

        def __get__(self, settings: object, owner: type) -> tuple[float, float]:
            """Ends of the range."""

        def __set__(self, settings: object, value: float | tuple[float, float]) -> None:
            """Make the range of its ends, or of one number."""
else:
    Range = tuple[float, float]
    """Type of a setting that is a range: its ends, for which one number may stand."""

Check = Callable[[str, Any], Any]


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

    def __str__(self) -> str:
        """The range in words."""
        return f"{self.low:.10g} to {self.high:.10g} {self.unit}".rstrip()


def types_of(config_type: type, annotated: bool = False) -> Mapping[str, Any]:
    """Types of the fields of a dataclass by name.

    :param config_type: the dataclass
    :param annotated: whether the types have their annotations, such as ranges
    """
    return _read(config_type).annotated if annotated else _read(config_type).types


def ranges_of(config_type: type) -> Mapping[str, Within]:
    """Ranges of the fields of a dataclass by name; a field without one is left out.

    :param config_type: the dataclass
    """
    return _read(config_type).ranges


def check_ranges(key: str, config: object) -> None:
    """Refuse settings of which one is not within its range, and make their numbers Python's own.

    The same holds for names of a ``Literal``, for ``bool`` and for settings within settings.

    :param key: beginning of the fields' names in messages
    :param config: settings to check while they are made, a frozen dataclass
    :raises ConfigurationError: naming key, value and range
    """
    checks = _read(type(config)).checks  # type: ignore[arg-type]  # mypy takes classes for unhashable
    for name, check in checks.items():
        object.__setattr__(config, name, check(f"{key}{name}", getattr(config, name)))


class _Hints(NamedTuple):
    types: dict[str, Any]
    annotated: dict[str, Any]
    ranges: dict[str, Within]
    checks: dict[str, Check]


@cache
def _read(config_type: type) -> _Hints:
    """What the types of the fields say, read once, because that takes longer than a check."""
    annotated = get_type_hints(config_type, include_extras=True)
    ranges = {name: within for name, kind in annotated.items() if (within := _range_in(kind))}
    checks = {name: _check_of(annotated[name], within) for name, within in ranges.items()}
    checks |= {name: partial(_checked, kind) for name, kind in annotated.items() if _is_checked(kind)}
    return _Hints(get_type_hints(config_type), annotated, ranges, checks)


def _is_checked(kind: Any) -> bool:
    return kind is bool or is_dataclass(kind) or get_origin(kind) is Literal


def _checked(kind: Any, key: str, value: Any) -> Any:
    """A value that has no range: it has to be of its type, or one of its names."""
    value = plain(value)
    if get_origin(kind) is not Literal:
        check_type(key, value, kind)
    elif value not in get_args(kind):
        raise ConfigurationError(unknown_name(key, str(value), get_args(kind)))
    return value


def _range_in(kind: Any) -> Within | None:
    """Range of a type, or of the first of its parts that has one."""
    if isinstance(kind, Within):
        return kind
    return next(filter(None, map(_range_in, get_args(kind))), None)


def _check_of(kind: Any, within: Within) -> Check:
    """Check of a value of a type; of a union, the first type has the range."""
    parts, limits = get_args(kind), (within.low, within.high, within.unit)
    if get_origin(kind) is Annotated:
        if parts[0] == Range:
            return lambda key, value: check_ends(key, value, *limits)
        if parts[0] is int:
            return lambda key, value: check_whole(key, value, *limits)
        return lambda key, value: float(check_range(key, value, *limits))
    check = _check_of(parts[0], within)
    if get_origin(kind) is tuple:
        return lambda key, value: tuple(check(key, item) for item in value)
    others = (None,) if parts[1] is NoneType else get_args(parts[1])
    return lambda key, value: value if isinstance(value, (str, NoneType)) and value in others else check(key, value)
