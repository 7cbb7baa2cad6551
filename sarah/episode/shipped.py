"""The file of learned parameters that the package ships, which ``make results NAME=shipped_parameters`` writes."""

from __future__ import annotations

import json
from collections.abc import Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

from sarah.control.parameters import Parameter
from sarah.errors import ConfigurationError, check_range

FILE = Path(__file__).with_name("parameter_sets.json")


@lru_cache
def shipped() -> dict[str, dict[str, Any]]:
    """Content of the file, by the name of the parameters: task, parameters, settings, figures and origin.

    :raises ConfigurationError: naming the file, if it cannot be read
    """
    try:
        content: Any = json.loads(FILE.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ConfigurationError(f"cannot read {FILE}: {getattr(error, 'strerror', None) or error}") from error
    if not isinstance(content, dict):
        raise ConfigurationError(f"{FILE} must hold parameters by name")
    return content


def shipped_value(*keys: str) -> Any:
    """Value of the file.

    :param keys: name of the parameters, and then the key within each mapping
    :raises ConfigurationError: naming the file and the keys, if there is no such value
    """
    value: Any = shipped()
    for number, key in enumerate(keys, start=1):
        if not isinstance(value, dict) or key not in value:
            raise ConfigurationError(f"{FILE}: {'.'.join(keys[:number])} is missing")
        value = value[key]
    return value


def shipped_parameters(name: str, parameters: Sequence[Parameter]) -> tuple[Any, ...]:
    """Values of the file's parameters, in order.

    :param name: name of the set
    :param parameters: parameters that the set must have, and no others
    :raises ConfigurationError: naming the file and the parameter that is missing, unknown or out of its range
    """
    values = [shipped_value(name, "parameters", parameter.name) for parameter in parameters]
    for unknown in set(shipped_value(name, "parameters")) - {parameter.name for parameter in parameters}:
        raise ConfigurationError(f"{FILE}: {name}.parameters.{unknown} is not known")
    for parameter, value in zip(parameters, values, strict=True):
        check_range(f"{FILE}: {name}.parameters.{parameter.name}", value, parameter.low, parameter.high, parameter.unit)
    return tuple(map(float, values))
