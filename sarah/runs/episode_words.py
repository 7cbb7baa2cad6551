"""What is special about an episode in words: for tables, and for what a picture of it cannot show."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import Any

from sarah.episode.push import NO_PUSH, PushedConfig, push_words
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task
from sarah.episode.trace import Trace
from sarah.runs.config_files import settings_by_key
from sarah.simulation.terrain import Terrain, draw_terrain

SAID_BY_THEMSELVES = {"engine", "push.newtons", "stepping"}
"""Settings that are named in any case, or in other words."""
MOST_PUSHES = 3
"""Largest number of pushes that are named."""
MOST_DIMENSIONS = 3
"""Largest number of dimensions that are named beside a picture."""


def changed_settings(task: Task[Any], config: EpisodeConfig, subject: EpisodeConfig | None = None) -> Iterator[str]:
    """Settings that are not those of the task in the same engine and for a robot of that size, with their values.

    :param task: task of the episodes
    :param config: settings of the episodes
    :param subject: settings of what they are made of; where those are special and not kept, both values are given
    """
    usual, there = _usual(task, config), settings_by_key(subject or config)
    usual_there = _usual(task, subject or config)
    for name, value in settings_by_key(config).items():
        other = there.get(name, value)
        is_replaced = value != other != usual_there.get(name)
        if name not in SAID_BY_THEMSELVES and (value != usual.get(name) or is_replaced):
            yield f"{name} {_text(value)}{f' instead of {_text(other)}' if is_replaced else ''}"


def _usual(task: Task[Any], config: EpisodeConfig) -> dict[str, Any]:
    """Settings of a task by name, in the engine of others and for a robot of that size."""
    of_size: EpisodeConfig = task.episode.for_robot(config.dimensions)
    usual = replace(of_size, engine=config.engine, dimensions=task.episode.dimensions)
    if isinstance(config, PushedConfig) and not isinstance(usual, PushedConfig):
        usual = PushedConfig(**vars(usual), push=config.scale.scaled(NO_PUSH))
    return settings_by_key(usual)


def differences(config: EpisodeConfig, subject: EpisodeConfig) -> Iterator[str]:
    """Settings of episodes that are not those of what they are made of, each with both values.

    P1 to P5 that only one of both has are left out.

    :param config: settings of the episodes
    :param subject: settings of what a command was given, such as a run folder
    """
    here, there = _by_name(config, subject), _by_name(subject, config)
    for name in here | there:
        value, other = here.get(name), there.get(name)
        if value != other and not (name == "stepping" and None in (value, other)):
            if isinstance(value, Mapping) and isinstance(other, Mapping):  # dimensions
                value, other = _only_here(value, other), _only_here(other, value)
            yield f"{name} {_text(value)} instead of {_text(other)}"


def _only_here(values: Mapping[str, Any], others: Mapping[str, Any]) -> dict[str, Any]:
    """Values that others lack, or have otherwise."""
    return {name: value for name, value in values.items() if others.get(name) != value}


def _by_name(config: EpisodeConfig, other: EpisodeConfig) -> dict[str, Any]:
    """Settings by name; a push that only one of both has is one setting."""
    if isinstance(config, PushedConfig) and not isinstance(other, PushedConfig):
        shared = {name: value for name, value in settings_by_key(config).items() if not name.startswith("push.")}
        return {**shared, "push": settings_by_key(config.push)}
    return settings_by_key(config)


def told_of(spec: EpisodeSpec, trace: Trace) -> list[str]:
    """What a picture of an episode leaves out or shows for a moment: its pushes, and settings that are not usual.

    :param spec: specification of the episode
    :param trace: trace of the episode
    """
    pushes = [f"{' '.join(push_words(trace.push[begin]))} at {trace.time[begin]:.2f} s" for begin, _ in trace.pushes()]
    more = [f"and {len(pushes) - MOST_PUSHES} more"] if len(pushes) > MOST_PUSHES else []
    return [*pushes[:MOST_PUSHES], *more, *told_settings(spec)]


def told_settings(spec: EpisodeSpec) -> list[str]:
    """Settings of an episode that are not the task's own, except its push; the ground as the seed draws it.

    :param spec: specification of the episode
    """
    usual, config = spec.task.episode, spec.config
    engine = [] if config.engine == usual.engine else [f"engine {config.engine}"]
    stepping = getattr(config, "stepping", None)
    is_usual = stepping == getattr(usual, "stepping", None)
    legs = [] if stepping is None or is_usual else [f"P1 to P5 {', '.join(f'{value:.2f}' for value in stepping)}"]
    terrain = _drawn(config.terrain, config.scale.scaled(usual.terrain), spec.seed)
    drawn = replace(config, terrain=terrain)
    changed = [words for words in changed_settings(spec.task, drawn) if not words.startswith("push.")]
    if (count := len(config.dimensions)) > MOST_DIMENSIONS:
        changed = [f"{count} dimensions of its own" if words.startswith("dimensions ") else words for words in changed]
    return [*engine, *legs, *changed]


def _drawn(ranges: Terrain, usual: Terrain, seed: int) -> Terrain:
    """Ground as an episode's seed draws it, to three digits, where its ranges are not the usual ones."""
    drawn = draw_terrain(ranges, seed)
    names = {name for name in vars(ranges) if getattr(ranges, name) != getattr(usual, name)}
    if "slope_degrees" in names:
        names.add("direction_degrees")
    values = {name: getattr(drawn, name) for name in names}
    ranges_of_drawn = {name: value for name, value in values.items() if isinstance(value, tuple)}
    rounded = {name: (float(f"{value:.3g}"),) * 2 for name, (value, _) in ranges_of_drawn.items()}
    return replace(usual, **{**values, **rounded})


def _text(value: Any) -> str:
    """Text of a setting; of a range both ends, unless they are equal; of P1 to P5 all."""
    if value is None or value == {}:
        return "none"
    if isinstance(value, list):
        of_range = len(value) == 2
        return (" to " if of_range else ", ").join(f"{one:g}" for one in (dict.fromkeys(value) if of_range else value))
    if isinstance(value, Mapping):
        return ", ".join(f"{name} {_text(inner)}" for name, inner in value.items())
    return f"{value:g}" if isinstance(value, float) else str(value)
