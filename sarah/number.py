"""Numbers from outside: texts spell them in one way, and they become Python's own types, whatever they come as.

Settings files, tables and Python accept and refuse the same as the command line.
"""

from __future__ import annotations

import math
import re
import reprlib
from decimal import Decimal
from numbers import Real
from typing import Any

_DIGITS = "(?:0|[1-9][0-9]{0,999})"
WHOLE = re.compile(rf"[-+]?{_DIGITS}\Z")
"""A whole number: decimal, without leading zeros, which YAML 1.1 takes for octal, and without underscores."""
_DECIMAL = rf"(?:{_DIGITS}(?:\.[0-9]{{0,999}})?|\.[0-9]{{1,999}})(?:e[-+]?[0-9]{{1,9}})?"
NUMBER = re.compile(rf"[-+]?{_DECIMAL}\Z", re.IGNORECASE)
"""A number, such as ``3``, ``.5`` or ``1e-4``."""


def whole_number(text: str) -> int:
    """Read a whole number.

    :param text: text that a user gave
    :raises ValueError: if it is none, with the rest of a sentence that begins with the name
    """
    if not WHOLE.match(text):
        raise ValueError(f"must be a whole number, not {reprlib.repr(text)}")
    return int(text)


def number(text: str) -> float:
    """Read a number.

    :param text: text that a user gave
    :raises ValueError: if it is none that a float can hold, with the rest of a sentence that begins with the name
    """
    if not NUMBER.match(text) or math.isinf(float(text)):
        raise ValueError(f"must be a number, not {reprlib.repr(text)}")
    return float(text)


def plain(value: Any) -> Any:
    """Python's own value for one of numpy's, for an array or a fraction. What is none of these stays as it is.

    A setting of numpy's single precision would make a whole episode one of single precision.

    :param value: value of any type
    :return: ``int``, ``float``, ``bool`` or ``str``; a list for an array, unless it has no dimensions
    """
    value = value.tolist() if hasattr(value, "tolist") else value
    is_real = isinstance(value, (Real, Decimal)) and not isinstance(value, (int, float))
    return float(value) if is_real else value


def is_number(value: object) -> bool:
    """Whether a value is a number of Python's own; truth values are none.

    :param value: value as :func:`plain` returns it
    """
    return isinstance(value, (int, float)) and not isinstance(value, bool)


def is_finite(value: object) -> bool:
    """Whether a value is a number of any type that a float can hold; truth values are 0 and 1.

    :param value: value of any type
    """
    value = plain(value)
    try:
        return isinstance(value, (int, float)) and math.isfinite(value)
    except OverflowError:  # a whole number beyond all floats
        return False


def to_floats(config: object, *names: str) -> None:
    """Make floats of the numbers among the fields of a frozen dataclass, while it is made. Other values stay.

    :param config: object to change
    :param names: names of the fields
    """
    for name in names:
        value = getattr(config, name)
        object.__setattr__(config, name, float(plain(value)) if is_finite(value) else plain(value))
