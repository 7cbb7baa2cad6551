"""Settings as YAML files: reading names every mistake, and writing makes files that can be read back."""

from __future__ import annotations

import contextlib
import dataclasses
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any, TypeVar

from sarah.episode.from_mapping import changed_alone, from_mapping
from sarah.episode.tasks import Task
from sarah.errors import ConfigurationError, SarahError
from sarah.files import read_text, replace_text
from sarah.formats import read_yaml

ConfigType = TypeVar("ConfigType")


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


def read_config(
    config_type: type[ConfigType],
    path: Path,
    task: Task[Any] | None = None,
    dimensions: Mapping[str, float] = MappingProxyType({}),
) -> ConfigType:
    """Read a configuration from a YAML file. Fields that the file does not name keep their defaults.

    No task is loaded for that: a file that names one of another file needs it here.

    :param config_type: dataclass of the configuration
    :param path: path of the file
    :param task: task that takes the place of the one that the file names
    :param dimensions: dimensions of the robot that come beside those of the file. What the file names stays as it is;
        what it does not name goes with them
    :raises ConfigurationError: naming file, key and value, if a value is not allowed
    """
    content = _read(path)
    if task is not None and isinstance(content, dict):
        content["task"] = task
    if dimensions and isinstance(content, dict):
        episode = content.setdefault("episode", {})
        own = episode.get("dimensions", {}) if isinstance(episode, dict) else None
        if isinstance(own, dict):  # anything else is refused below
            episode["dimensions"] = {**own, **dimensions}
    with _naming(path):
        return from_mapping(config_type(), content)


def read_section(default: ConfigType, path: Path, name: str) -> ConfigType:
    """Change recorded settings by one section of a YAML file, which :func:`read_config` has read without a mistake.

    :param default: settings whose values stay where the section names no others, a dataclass
    :param path: path of the file
    :param name: name of the section; all values stay if the file lacks it
    :raises ConfigurationError: naming file, key and value, if a value is not allowed beside those that stay
    """
    section = _read(path).get(name, {})
    with _naming(path):
        return changed_alone(default, section, f"{name}.")


def _read(path: Path) -> Any:
    """Content of a YAML file; an empty one names nothing."""
    try:
        text = read_text(path)
    except OSError as error:
        raise ConfigurationError(f"cannot read {path}: {error.strerror or error}") from error
    with _naming(path):
        content = read_yaml(text)
    return {} if content is None else content


@contextlib.contextmanager
def _naming(path: Path) -> Iterator[None]:
    """Name a file in the message about a mistake in it."""
    try:
        yield
    except SarahError as error:
        raise ConfigurationError(f"{path}: {error}") from error


def write_config(config: Any, path: Path, *removed: Path) -> None:
    """Write a configuration as YAML with all its values, so that :func:`read_config` returns it.

    :param config: configuration, a dataclass
    :param path: path of the file
    :param removed: paths of results of the configuration before, which go when this one is on the disk
    """
    import yaml

    replace_text(path, yaml.safe_dump(_to_plain(config), sort_keys=False), *removed)


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


def changed_alike(config: ConfigType, before: Any, after: Any) -> ConfigType:
    """Make the changes of one configuration in another, which keeps the rest.

    :param config: configuration to change, a dataclass
    :param before: configuration of the same type, as it was
    :param after: the same with the changes
    """
    values: dict[str, Any] = {}
    for item in dataclasses.fields(after):
        own, was, value = (getattr(each, item.name, None) for each in (config, before, after))
        if value != was:
            is_same_kind = dataclasses.is_dataclass(value) and type(own) is type(value)
            values[item.name] = changed_alike(own, was, value) if is_same_kind else value
    return dataclasses.replace(config, **values)  # type: ignore[type-var]  # a dataclass


def _to_plain(value: Any) -> Any:
    """Convert tuples to lists, because safe YAML loaders refuse tuples, and settings to mappings."""
    if isinstance(value, Task):
        return value.reference
    if dataclasses.is_dataclass(value):
        return {item.name: _to_plain(getattr(value, item.name)) for item in dataclasses.fields(value)}
    if isinstance(value, Mapping):
        return {key: _to_plain(item) for key, item in value.items()}
    return [_to_plain(item) for item in value] if isinstance(value, tuple) else value
