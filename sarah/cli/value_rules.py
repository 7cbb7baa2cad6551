"""How the command line reads a task, a range, a number and dimensions, and how it shows them and settings."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Mapping, Sequence
from types import NoneType, UnionType
from typing import Annotated, Any, Union, get_args

import docstring_parser
import tyro

from sarah.control.supervisor_settings import SupervisorSettings
from sarah.episode.robot_settings import RobotSettings
from sarah.episode.tasks import Task, load_task
from sarah.number import number, whole_number
from sarah.ranges import ranges_of, types_of
from sarah.simulation.randomisation import Randomisation

SHORT = {
    (RobotSettings, "engine"): "--engine",
    (Randomisation, "enabled"): "--randomisation",
    (SupervisorSettings, "enabled"): "--supervisor",
}
"""Short options of settings of episodes, by the settings' type and name."""


def _task_rule(info: tyro.constructors.PrimitiveTypeInfo) -> tyro.constructors.PrimitiveConstructorSpec[Any] | None:
    """How tyro reads a task from the command line, and shows one."""
    if Task not in (info.type, info.type_origin):
        return None
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs=1,
        metavar="TASK",
        instance_from_str=lambda words: load_task(words[0]),
        is_instance=lambda value: isinstance(value, Task),
        str_from_instance=lambda task: [task.reference],
    )


def _range_rule(info: tyro.constructors.PrimitiveTypeInfo) -> tyro.constructors.PrimitiveConstructorSpec[Any] | None:
    """How tyro shows a range, of which one number may stand for both ends."""
    if info.type_origin is not tuple or get_args(info.type) != (float, float):
        return None
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs=2,
        metavar="FLOAT [FLOAT]",
        instance_from_str=lambda words: tuple(map(number, words)),
        is_instance=lambda value: isinstance(value, tuple) and len(value) == 2,
        str_from_instance=lambda ends: list(map(str, ends)),
    )


def _number_rule(info: tyro.constructors.PrimitiveTypeInfo) -> tyro.constructors.PrimitiveConstructorSpec[Any] | None:
    """How tyro reads a number that may be none: it takes Python's spellings itself, such as ``0100`` and ``1_000``."""
    kind, *others = get_args(info.type) if info.type_origin in (Union, UnionType) else (info.type,)
    if kind not in (int, float) or others not in ([], [NoneType]):
        return None
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs=1,
        metavar="INT" if kind is int else "FLOAT",
        instance_from_str=lambda words: (whole_number if kind is int else number)(words[0]),
        is_instance=lambda value: isinstance(value, info.type),
        str_from_instance=lambda value: [str(value)],
    )


def _dimensions(given_already: Mapping[str, float]) -> tyro.constructors.PrimitiveConstructorSpec[Any]:
    """How tyro reads dimensions: names and numbers in turn, beside those that differ from their defaults already."""
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs="*",
        metavar="NAME FLOAT",
        instance_from_str=lambda words: {**given_already, **named_numbers(words)},
        is_instance=lambda value: isinstance(value, Mapping),
        str_from_instance=lambda given: [word for name, value in given.items() for word in (name, f"{value:g}")],
    )


def named_numbers(words: Sequence[str]) -> dict[str, float]:
    """Numbers by name, from words that are names and numbers in turn.

    :param words: the words
    :raises ValueError: if one of the numbers is none, or missing
    """
    if len(words) % 2:
        raise ValueError(f"must be names and numbers in turn, and {words[-1]!r} has no number")
    return {name: number(word) for name, word in zip(words[::2], words[1::2], strict=True)}


def _settings_rule(info: tyro.constructors.StructTypeInfo) -> tyro.constructors.StructConstructorSpec | None:
    """How tyro shows settings: beside the default of each stands its range."""
    ranges = ranges_of(info.type) if dataclasses.is_dataclass(info.type) else {}
    if not ranges:
        return None
    types, fields = dict(types_of(info.type, annotated=True)), []
    for name, within in ranges.items():
        hint = f"({within}; default: {{}})".format
        types[name] = Annotated[types_of(info.type)[name], tyro.conf.arg(help_behavior_hint=hint)]
    for name, kind in types.items():
        if name == "dimensions":
            kind = Annotated[kind, _dimensions(info.default.dimensions)]
        for (owner, setting), short in SHORT.items():
            if name == setting and issubclass(info.type, owner):
                kind = Annotated[kind, tyro.conf.arg(aliases=[short])]
        meaning = functools.partial(_meaning, info.type, name)
        fields.append(tyro.constructors.StructFieldSpec(name, kind, getattr(info.default, name), meaning))
    return tyro.constructors.StructConstructorSpec(info.type, tuple(fields))


def _meaning(config_type: type, name: str) -> str | None:
    return meanings_of(config_type).get(name)


@functools.cache
def meanings_of(config_type: type) -> dict[str, str]:
    """What each ``:param:`` line of a dataclass and of those it extends says.

    :param config_type: the dataclass
    """
    style = docstring_parser.DocstringStyle.REST
    parsed = (docstring_parser.parse(base.__doc__ or "", style) for base in reversed(config_type.__mro__))
    return {p.arg_name: " ".join((p.description or "").split()) for docstring in parsed for p in docstring.params}


REGISTRY = tyro.constructors.ConstructorRegistry()
"""Rules for tyro."""
REGISTRY.primitive_rule(_number_rule)
REGISTRY.primitive_rule(_task_rule)
REGISTRY.primitive_rule(_range_rule)
REGISTRY.struct_rule(_settings_rule)
