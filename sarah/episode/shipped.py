"""The file of learned parameters that the package ships, which ``make results NAME=shipped_parameters`` writes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from sarah.control.parameters import Parameter

FILE = Path(__file__).with_name("parameter_sets.json")


@lru_cache
def shipped() -> dict[str, dict[str, Any]]:
    """Content of the file, by the name of the parameters: task, parameters, settings, figures and origin."""
    content: dict[str, dict[str, Any]] = json.loads(FILE.read_text(encoding="utf-8"))
    return content


def shipped_parameters(name: str, parameters: Sequence[Parameter]) -> tuple[Any, ...]:
    """Values of the file's parameters, in order.

    :param name: name of the set
    :param parameters: parameters of the set
    """
    values = shipped()[name]["parameters"]
    return tuple(values[parameter.name] for parameter in parameters)
