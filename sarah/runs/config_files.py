"""Settings as YAML files: reading names every mistake, and writing makes files that can be read back."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any, TypeVar

from sarah.episode.from_mapping import from_mapping
from sarah.episode.tasks import Task
from sarah.errors import ConfigurationError, SarahError, shortened
from sarah.files import read_text, replace_text

ConfigType = TypeVar("ConfigType")
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


def read_config(config_type: type[ConfigType], path: Path, task: Task[Any] | None = None) -> ConfigType:
    """Read a configuration from a YAML file. Fields that the file does not name keep their defaults.

    No task is loaded for that: a file that names one of another file needs it here.

    :param config_type: dataclass of the configuration
    :param path: path of the file
    :param task: task that takes the place of the one that the file names
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
        content = {} if content is None else content
        if task is not None and isinstance(content, dict):
            content["task"] = task
        return from_mapping(config_type(), content)
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

    replace_text(path, yaml.safe_dump(_to_plain(config), sort_keys=False))


def settings_by_key(config: Any) -> dict[str, Any]:
    """All values of a configuration by their full names, such as ``episode.push.newtons``, as JSON would return them.

    :param config: configuration, a dataclass
    """
    found: dict[str, Any] = {}
    for item in dataclasses.fields(config):
        value = getattr(config, item.name)
        if isinstance(value, Task):
            found[item.name] = value.identity
        elif dataclasses.is_dataclass(value):
            found |= {f"{item.name}.{key}": inner for key, inner in settings_by_key(value).items()}
        else:
            found[item.name] = _to_plain(value)
    return found


def _to_plain(value: Any) -> Any:
    """Convert tuples to lists, because safe YAML loaders refuse tuples, and settings to mappings."""
    if isinstance(value, Task):
        return value.reference
    if dataclasses.is_dataclass(value):
        return {item.name: _to_plain(getattr(value, item.name)) for item in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {key: _to_plain(item) for key, item in value.items()}
    if isinstance(value, float):  # numpy's floats are floats that no YAML knows
        return float(value)
    return [_to_plain(item) for item in value] if isinstance(value, tuple) else value
