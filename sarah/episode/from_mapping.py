"""Settings from names and values, as YAML or keywords give them: every mistake is named."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from typing import Any, Literal, TypeVar, Union, get_args, get_origin

from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import TASKS, Task, task_named
from sarah.errors import LONGEST_NAME, ConfigurationError, shortened, unknown_name
from sarah.number import is_number, plain
from sarah.ranges import Range, types_of

ConfigType = TypeVar("ConfigType")


def from_mapping(default: ConfigType, content: Any, key: str = "") -> ConfigType:
    """Change some settings.

    :param default: settings whose values stay where no others are given, a dataclass
    :param content: new values by name; settings within settings are mappings or dataclasses
    :param key: prefix of the names in messages
    :raises ConfigurationError: naming key and value, if a value is not allowed
    """
    if isinstance(content, type(default)):
        return content
    if not isinstance(content, Mapping):
        raise ConfigurationError(f"{key.rstrip('.') or 'the file'} must hold keys and values, not {shortened(content)}")
    types = types_of(type(default))
    dependent: dict[str, Any] = getattr(default, "dependent_defaults", lambda _: {})(content)
    values = dict(dependent)
    for name, value in content.items():
        if name not in types:
            raise ConfigurationError(_unknown_key(default, name, key))
        inner = dependent.get(name, getattr(default, name))
        if dataclasses.is_dataclass(inner) and not isinstance(inner, Task):
            values[name] = from_mapping(inner, value, f"{key}{name}.")
            continue
        values[name] = _converted(types[name], value, key + name)
        if isinstance(inner, Mapping):
            values[name] = {**inner, **values[name]}
    return dataclasses.replace(default, **values)  # type: ignore[type-var]  # a dataclass


def changed_alone(config: ConfigType, content: Any, key: str = "") -> ConfigType:
    """Change some settings that were recorded; another dimension changes the robot, and no other setting.

    :param config: settings of episodes
    :param content: new values by name
    :param key: prefix of the names in messages
    :raises ConfigurationError: naming key and value, if a value is not allowed
    """
    given = content.get("dimensions") if isinstance(content, Mapping) else None
    if not isinstance(given, Mapping):
        return from_mapping(config, content, key)
    rest = {name: value for name, value in content.items() if name != "dimensions"}
    changed: Any = from_mapping(config, rest, key)
    dimensions = _converted(Mapping[str, float], given, f"{key}dimensions")
    return dataclasses.replace(changed, dimensions={**changed.dimensions, **dimensions})


def convert_fields(config: Any, key: str = "") -> None:
    """Convert the fields of settings to their types, while they are made; YAML and keywords come converted already.

    :param config: settings, a dataclass
    :param key: prefix of the names in messages
    :raises ConfigurationError: naming key and value, if a value is of another type
    """
    for name, expected in types_of(type(config)).items():
        object.__setattr__(config, name, _converted(expected, getattr(config, name), key + name))


def _unknown_key(default: Any, name: Any, key: str) -> str:
    """Message about a key that settings lack; settings within them may have it, or those of another task.

    :param default: the settings, a dataclass
    :param name: the key
    :param key: prefix of the names in messages
    """
    names = [item.name for item in dataclasses.fields(default)]
    for outer in names:
        inner = getattr(default, outer)
        is_settings = dataclasses.is_dataclass(inner) and not isinstance(inner, Task)
        if is_settings and name in [item.name for item in dataclasses.fields(inner)]:
            return f"unknown key {key + name!r}, did you mean {f'{key}{outer}.{name}'!r}?"
    having = [task.name for task in TASKS.values() if name in task.episode.__dataclass_fields__]
    if isinstance(default, EpisodeConfig) and having:
        return f"{key}{name} is for task {' or '.join(having)}"
    return unknown_name("key", f"{key}{name}", (key + allowed for allowed in names))


def _converted(expected: Any, value: Any, key: str) -> Any:
    """Convert a value to the expected type, or raise an error that names the key."""
    value = plain(value)
    if type(None) in get_args(expected):
        (expected,) = (one for one in get_args(expected) if one is not type(None))
        return None if value is None else _converted(expected, value, key)
    if expected is Any:
        return value
    if isinstance(expected, type) and dataclasses.is_dataclass(expected):
        return value if isinstance(value, expected) else _made(expected, value, key)
    if get_origin(expected) is Task:
        return value if isinstance(value, Task) else task_named(_converted(str, value, key))
    if get_origin(expected) is tuple:
        return _converted_tuple(get_args(expected), value, key)
    if get_origin(expected) is Union:
        number, names = get_args(expected)
        return _converted(names if isinstance(value, str) else number, value, key)
    if get_origin(expected) is Mapping:
        if not isinstance(value, Mapping):
            raise ConfigurationError(f"{key} must hold names and values, not {shortened(value)}")
        return {name: _converted(get_args(expected)[1], item, f"{key}.{_short(name)}") for name, item in value.items()}
    allowed = {float: (float, int), int: (int,), bool: (bool,)}.get(expected, (str,))
    if not isinstance(value, allowed) or (isinstance(value, bool) and expected is not bool):
        kind = {float: "a number", int: "a whole number", bool: "true or false"}.get(expected, "a text")
        raise ConfigurationError(f"{key} must be {kind}, not {shortened(value)}")
    if get_origin(expected) is Literal and value not in get_args(expected):
        raise ConfigurationError(unknown_name(key, str(value), get_args(expected)))
    try:
        return float(value) if expected is float else value
    except OverflowError:
        raise ConfigurationError(f"{key} must be a number that a float can hold, not {shortened(value)}") from None


def _made(expected: Any, content: Any, key: str) -> Any:
    """A dataclass without defaults, of a mapping that names all its fields."""
    types = types_of(expected)
    if not isinstance(content, Mapping) or content.keys() != types.keys():
        raise ConfigurationError(f"{key} must hold {' and '.join(types)}, not {shortened(content)}")
    return expected(**{name: _converted(types[name], value, f"{key}.{name}") for name, value in content.items()})


def _short(name: Any) -> str:
    """A key as it stands in the file, unless a line cannot hold it."""
    return name if isinstance(name, str) and name.isidentifier() and len(name) <= LONGEST_NAME else shortened(name)


def _converted_tuple(parts: tuple[Any, ...], value: Any, key: str) -> tuple[Any, ...]:
    """A tuple of the expected parts, of which an ellipsis stands for as many as there are of the one before it."""
    if parts == get_args(Range) and is_number(value):
        value = (value, value)  # one number is both ends of a range
    is_list = isinstance(value, (list, tuple))
    if Ellipsis in parts:
        parts = (parts[0],) * len(value) if is_list else ()
    if not is_list or len(value) != len(parts):
        values = f"a list of {len(parts)} values" if parts else "a list"
        if parts == get_args(Range):
            values = "one number, or a list of 2 for a range"
        raise ConfigurationError(f"{key} must be {values}, not {shortened(value)}")
    return tuple(_converted(part, item, key) for part, item in zip(parts, value, strict=True))
