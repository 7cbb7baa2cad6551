"""Settings as YAML files: reading names every mistake, and writing makes files that can be read back."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal, TypeVar, Union, get_args, get_origin, get_type_hints

from sarah.errors import LONGEST_NAME, ConfigurationError, SarahError, shortened, unknown_name
from sarah.files import read_text, replace_text
from sarah.robot.description import check_dimensions
from sarah.runs.config import TrainingConfig

ConfigType = TypeVar("ConfigType")
EXPONENT = re.compile(r"[-+]?\d+[eE][-+]?\d+")
"""Numbers such as 3e-4, which YAML 1.1 takes for texts as they have no decimal point."""
LONGEST_REASON = 500
"""Length up to which a message quotes YAML's own, in characters."""
DEEPEST = 20
"""Largest number of lists and mappings in a settings file that lie in each other."""


def first_difference(config: Any, other: Any) -> tuple[str, Any, Any] | None:
    """Find the first difference between two configurations.

    :param config: configuration, a dataclass
    :param other: configuration to compare with
    :return: the key and both values; ``None`` if the configurations are equal
    """
    here, there = settings_by_key(config), settings_by_key(other)
    for key in here:
        if here[key] != there.get(key):
            return key, here[key], there.get(key)
    return None


def read_config(config_type: type[ConfigType], path: Path) -> ConfigType:
    """Read a configuration from a YAML file. Fields that the file does not name keep their defaults.

    :param config_type: dataclass of the configuration
    :param path: path of the file
    :raises ConfigurationError: naming file, key and value, if a value is not allowed
    """
    import yaml

    try:
        text = read_text(path)
        _check_structure(text)
        content = yaml.safe_load(text)
        repeated = _repeated_key(yaml.compose(text, yaml.SafeLoader))
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigurationError(f"cannot read {path}: {getattr(error, 'strerror', None) or error}") from error
    except SarahError as error:
        raise ConfigurationError(f"{path}: {error}") from error
    # The safe loader lets errors of its conversions through: of !!bool x, of a sexagesimal number without end.
    except (yaml.YAMLError, ValueError, LookupError, ArithmeticError) as error:
        raise ConfigurationError(f"{path} is not YAML: {' '.join(str(error).split())[:LONGEST_REASON]}") from error
    if repeated is not None:
        raise ConfigurationError(f"{path}: key {shortened(repeated)} is given twice")
    try:
        config = _from_mapping(config_type, {} if content is None else content, "")
        if isinstance(config, TrainingConfig):
            check_dimensions(config.episode.dimensions)
        return config
    except SarahError as error:
        raise ConfigurationError(f"{path}: {error}") from error


def _check_structure(text: str) -> None:
    """Refuse what makes a short text a large value: aliases, of which each can double it, and depth without end."""
    import yaml

    depth = 0
    for event in yaml.parse(text, yaml.SafeLoader):
        anchor = getattr(event, "anchor", None)
        if anchor is not None:
            raise ConfigurationError(f"anchors and aliases are not allowed, such as {shortened(anchor)}")
        depth += isinstance(event, yaml.CollectionStartEvent) - isinstance(event, yaml.CollectionEndEvent)
        if depth > DEEPEST:
            raise ConfigurationError(f"lists and mappings must lie at most {DEEPEST} deep in each other")


def _repeated_key(node: Any) -> str | None:
    """Find a key that a mapping gives more than once; YAML itself would silently keep the last one."""
    seen = set()
    for key, value in node.value if node is not None and node.id == "mapping" else ():
        if key.value in seen:
            return str(key.value)
        seen.add(key.value)
        if (found := _repeated_key(value)) is not None:
            return found
    return None


def write_config(config: Any, path: Path) -> None:
    """Write a configuration as YAML with all its values, so that :func:`read_config` returns it.

    :param config: configuration, a dataclass
    :param path: path of the file
    """
    import yaml

    replace_text(path, yaml.safe_dump(_to_plain(dataclasses.asdict(config)), sort_keys=False))


def settings_by_key(config: Any) -> dict[str, Any]:
    """All values of a configuration by their full names, such as ``episode.push.newtons``, as JSON would return them.

    :param config: configuration, a dataclass
    """
    found: dict[str, Any] = {}
    for item in dataclasses.fields(config):
        value = getattr(config, item.name)
        if dataclasses.is_dataclass(value):
            found |= {f"{item.name}.{key}": inner for key, inner in settings_by_key(value).items()}
        else:
            found[item.name] = _to_plain(value)
    return found


def _to_plain(value: Any) -> Any:
    """Convert tuples to lists, because safe YAML loaders refuse tuples."""
    if isinstance(value, Mapping):
        return {key: _to_plain(item) for key, item in value.items()}
    return [_to_plain(item) for item in value] if isinstance(value, tuple) else value


def _from_mapping(config_type: type[ConfigType], content: Any, key: str) -> ConfigType:
    if not isinstance(content, Mapping):
        raise ConfigurationError(f"{key.rstrip('.') or 'the file'} must hold keys and values, not {shortened(content)}")
    types = get_type_hints(config_type)
    types |= getattr(config_type, "field_types", lambda _: {})(content)
    values = {}
    for name, value in content.items():
        if name not in types:
            raise ConfigurationError(unknown_name("key", f"{key}{name}", (key + allowed for allowed in types)))
        values[name] = _converted(types[name], value, key + name)
    return config_type(**values)


def _converted(expected: Any, value: Any, key: str) -> Any:
    """Convert a value to the expected type, or raise an error that names the key."""
    if dataclasses.is_dataclass(expected):
        return _from_mapping(expected, value, f"{key}.")  # type: ignore[arg-type]
    if get_origin(expected) is tuple:
        return _converted_tuple(get_args(expected), value, key)
    if get_origin(expected) is Union:
        number, names = get_args(expected)
        return _converted(names if isinstance(value, str) else number, value, key)
    if get_origin(expected) is Mapping:
        if not isinstance(value, Mapping):
            raise ConfigurationError(f"{key} must hold names and values, not {shortened(value)}")
        return {name: _converted(get_args(expected)[1], item, f"{key}.{_short(name)}") for name, item in value.items()}
    if expected is float and isinstance(value, str) and EXPONENT.fullmatch(value):
        value = float(value)
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


def _short(name: Any) -> str:
    """A key as it stands in the file, unless a line cannot hold it."""
    return name if isinstance(name, str) and name.isidentifier() and len(name) <= LONGEST_NAME else shortened(name)


def _converted_tuple(parts: tuple[Any, ...], value: Any, key: str) -> tuple[Any, ...]:
    """A tuple of the expected parts, of which an ellipsis stands for as many as there are of the one before it."""
    is_list = isinstance(value, (list, tuple))
    if Ellipsis in parts:
        parts = (parts[0],) * len(value) if is_list else ()
    if not is_list or len(value) != len(parts):
        values = f"a list of {len(parts)} values" if parts else "a list"
        raise ConfigurationError(f"{key} must be {values}, not {shortened(value)}")
    return tuple(_converted(part, item, key) for part, item in zip(parts, value, strict=True))
