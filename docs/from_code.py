"""Generated parts of the documentation that come from the code: settings, parameters, metrics, commands, the robot.

``from_code("metrics")`` prints a part, by its name in :data:`PARTS`.
"""

from __future__ import annotations

import ast
import dataclasses
import inspect
import itertools
import os
import re
import subprocess
import sys
import textwrap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import Any

from experiments.tables import markdown_table
from sarah.cli.training_defaults import default_training
from sarah.cli.value_rules import meanings_of
from sarah.control.constants import STANDARD_CONSTANTS
from sarah.episode.result import METRICS
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import TASKS, Task
from sarah.episode.tick import Tick
from sarah.logs.topics import TOPICS
from sarah.ranges import ranges_of
from sarah.robot.description import JOINT_TYPES, describe_robot
from sarah.robot.dimensions import known_dimensions
from sarah.robot.reading import ACTUATED_JOINTS
from sarah.runs import agent_settings
from sarah.runs.agent_settings import AGENT_SETTINGS, LearnerSettings, NAFSettings
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import settings_by_key
from sarah.simulation.physics import PHYSICS, Physics
from sarah.training import recognise

HELP_WIDTH = 86
"""Of a command's help, in characters: as wide as the page."""
OF_SETTINGS = re.compile(r"╭─ (?:agent|episode)[.\w]* options ─+╮\n(?:│.*\n)*╰─+╯\n?")
"""Boxes of a command's help with the settings that another page lists."""


def from_code(name: str) -> None:
    """Print a part."""
    print("\n" + "\n".join(PARTS[name]()).strip() + "\n")


def settings_part() -> Iterator[str]:
    """A table for each group of settings of a training."""
    yield from section("Training", "", own_fields(TrainingConfig), {"default": TrainingConfig()})
    yield from agent_sections()
    yield from section("`episode`", "episode.", own_fields(EpisodeConfig), {"default": EpisodeConfig()})
    physics = PHYSICS["standard"]
    yield from section("`episode.physics`", "episode.physics.", own_fields(Physics), {"default": physics})
    pybullet_only = own_fields(type(physics), Physics)
    yield from section("`episode.physics`: PyBullet", "episode.physics.", pybullet_only, {"default": physics})
    yield from groups("episode.", EpisodeConfig(), leave_out="physics")
    of_tasks: dict[str, Any] = {}
    for task in TASKS.values():
        names = own_fields(type(task.episode), EpisodeConfig)
        title = f"`episode`: `--task {task.name}`"
        yield from section(title, "episode.", names, {"default": task.episode})
        of_tasks |= {name: value for name, value in vars(task.episode).items() if not hasattr(EpisodeConfig(), name)}
    yield from groups("episode.", of_tasks)


def defaults_part() -> Iterator[str]:
    """A table of the settings that ``sarah-train`` and ``sarah-compare`` begin with in place of a task's own."""
    rows = []
    for task in TASKS.values():
        own, of_commands = settings_by_key(TrainingConfig(task)), settings_by_key(default_training(task))
        changed = [name for name in own if own[name] != of_commands[name]]
        rows += [[f"`{task.name}`", f"`{name}`", shown(own[name]), shown(of_commands[name])] for name in changed]
    yield from table(["task", "setting", "the task's own", "the commands'"], rows)


def agent_sections() -> Iterator[str]:
    """A table of the settings that reinforcement learners share, and one for each algorithm that has others."""
    learners = {name: kind() for name, kind in AGENT_SETTINGS.items() if issubclass(kind, LearnerSettings)}
    yield from section("`agent`: all reinforcement learners", "agent.", own_fields(LearnerSettings), learners)
    for name, kind in AGENT_SETTINGS.items():
        columns: dict[str, Any] = {"default": kind()}
        if kind is NAFSettings:
            columns = {f"preset {preset}": NAFSettings().with_preset(preset) for preset in agent_settings.PRESETS}
        yield from section(f"`agent`: `--algo {name}`", "agent.", own_fields(kind, LearnerSettings), columns)


def groups(key: str, config: Any, leave_out: str = "") -> Iterator[str]:
    """A table for each dataclass within a configuration."""
    for name, value in (config if isinstance(config, dict) else vars(config)).items():
        if dataclasses.is_dataclass(value) and name != leave_out:
            yield from section(f"`{key}{name}`", f"{key}{name}.", own_fields(type(value)), {"default": value})


def section(title: str, key: str, names: Iterable[str], columns: Mapping[str, Any]) -> Iterator[str]:
    """A heading and a table of settings; nothing if there are none."""
    kind: type = type(next(iter(columns.values())))
    meanings, ranges = meanings_of(kind), ranges_of(kind)
    rows = []
    for name in names:
        values = [shown(getattr(config, name)) for config in columns.values()]
        rows.append([f"`{key}{name}`", *values, str(ranges.get(name, "")), markdown(meanings[name])])
    if rows:
        yield f"## {title}\n"
        yield from table(["setting", *columns, "range", "meaning"], rows)


def own_fields(config_type: Any, base: Any = None) -> list[str]:
    """Names of a dataclass's plain fields that another one does not have."""
    known = {field.name for field in dataclasses.fields(base)} if base else set()
    names = [field.name for field in dataclasses.fields(config_type) if field.name not in known]
    defaults = config_type()
    values = {name: getattr(defaults, name) for name in names}
    return [name for name, value in values.items() if isinstance(value, Task) or not dataclasses.is_dataclass(value)]


def parameters_part() -> Iterator[str]:
    """A table of each task's parameters."""
    for task in TASKS.values():
        yield f"## Task `{task.name}`\n"
        rows = ([p.name, f"{p.low:g} to {p.high:g}", p.unit, p.meaning, p.paper] for p in task.parameters)
        yield from table(["name", "range", "unit", "meaning", "paper"], rows)


def dimensions_part() -> Iterator[str]:
    """A table of the robot's dimensions."""
    rows = (
        [f"`{name}`", known.unit, f"{known.default:g}", f"{known.low:g} to {known.high:g}", known.meaning]
        for name, known in known_dimensions().items()
    )
    yield from table(["dimension", "unit", "default", "range", "meaning"], rows)


def metrics_part() -> Iterator[str]:
    """A table of what an episode is judged by."""
    rows = (
        [f"`{name}`", metric.unit, metric.meaning, ", ".join(metric.statistics), metric.paper]
        for name, metric in METRICS.items()
    )
    yield from table(["metric", "unit", "meaning", "statistics", "paper"], rows)


def tick_part() -> Iterator[str]:
    """A table of what a reward and an ending know."""
    fields = {name: markdown(meaning) for name, meaning in meanings_of(Tick).items() if name != "simulator"}
    properties = {
        name: markdown(str(member.__doc__).rstrip("."))
        for name, member in vars(Tick).items()
        if isinstance(member, property)
    }
    rows = ([f"`tick.{name}`", meaning[0].lower() + meaning[1:]] for name, meaning in (fields | properties).items())
    yield from table(["name", "what it is"], rows)
    yield "x points to the robot's right, y forward and z up. " + markdown(f"Actuators: {', '.join(ACTUATED_JOINTS)}.")


def topics_part() -> Iterator[str]:
    """A table of the topics of a log, and one of the fields of each topic."""
    names = {topic.name: f"`{topic.name}`" for topic in TOPICS.values()}
    yield from table(
        ["topic", "schema", "a message for"], ([names[t.name], f"`{t.schema}`", t.meaning] for t in TOPICS.values())
    )
    for topic in TOPICS.values():
        yield f"### {names[topic.name]}\n"
        rows = [[f"`{field.name}`", field.unit or field.kind, field.meaning] for field in topic.fields]
        yield from table(["field", "unit", "meaning"], rows)


POSITIVE = {
    "hip_abduction": "the foot goes to the left: outward on the left leg, inward on the right",
    "hip_flexion": "the foot goes forward",
    "leg_length": "the leg gets shorter",
}
"""Positive direction of each kind of actuator."""


def targets_part() -> Iterator[str]:
    """A table of the targets, in order."""
    robot, constants = describe_robot(), STANDARD_CONSTANTS
    hips = (-constants.largest_hip_angle, constants.largest_hip_angle, constants.hip_speed)
    legs = (-constants.shift_extension, constants.lift_retraction, constants.leg_speed)
    rows = []
    for index, joint in enumerate(ACTUATED_JOINTS):
        kind, unit = joint.partition("_")[2], "m" if JOINT_TYPES[joint] == "prismatic" else "rad"
        low, high, speed = legs if kind == "leg_length" else hips
        ends, effort = robot.limits[joint], f"{robot.efforts[joint]:g} {'N' if unit == 'm' else 'Nm'}"
        ranges = [f"{low:g} to {high:g} {unit}", f"{speed:g} {unit}/s", f"{ends[0]:g} to {ends[1]:g} {unit}"]
        rows.append([f"`targets[{index}]`", f"`{joint}`", POSITIVE[kind], *ranges, effort])
    head = ["target", "joint", "positive", "range of the target", "its speed", "range of the joint", "largest effort"]
    yield from table(head, rows)


def recognising_part() -> Iterator[str]:
    """A table of the constants by which the learner ``recognise`` decides."""
    statements = ast.parse(inspect.getsource(recognise)).body
    rows = []
    for statement, after in itertools.pairwise(statements):
        if isinstance(statement, ast.Assign) and isinstance(after, ast.Expr):
            name = ast.unparse(statement.targets[0])
            rows.append([f"`{name}`", str(getattr(recognise, name)), markdown(ast.literal_eval(after.value))])
    yield from table(["constant", "value", "meaning"], rows)


def commands_part() -> Iterator[str]:
    """What every command says to ``--help``, without the settings of a training, in the order of setup.cfg."""
    environment = {**os.environ, "COLUMNS": str(HELP_WIDTH), "NO_COLOR": "1"}
    for command in metadata.entry_points(group="console_scripts"):
        if command.name.startswith("sarah-"):
            path = Path(sys.executable).with_name(command.name)
            process = subprocess.run([path, "--help"], env=environment, capture_output=True, text=True, check=True)
            # tyro leaves what a command says of itself to the terminal to wrap.
            lines = (
                textwrap.fill(line, HELP_WIDTH) if len(line) > HELP_WIDTH else line.rstrip()
                for line in process.stdout.splitlines()
            )
            text = OF_SETTINGS.sub("", "\n".join(lines) + "\n").strip()
            yield f"## {command.name}\n\n```text\n{text}\n```\n"


def table(head: Sequence[str], rows: Iterable[Sequence[str]]) -> Iterator[str]:
    """Lines of a table, with an empty one after it."""
    yield from markdown_table(head, rows)
    yield ""


def markdown(text: str) -> str:
    """One line of Markdown from a docstring's reStructuredText."""
    text = re.sub(r":\w+(?::\w+)?:`~?([^`]+)`", r"`\1`", " ".join(text.split()))
    return text.replace("``", "`").replace("|", r"\|")


def shown(value: Any) -> str:
    """A default as the YAML file would hold it."""
    if isinstance(value, Task):
        return f"`{value.reference}`"
    if value in ((), {}):
        return "none"
    if isinstance(value, tuple):
        return f"`[{', '.join(map(str, value))}]`"
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"


PARTS: dict[str, Callable[[], Iterable[str]]] = {
    "commands": commands_part,
    "defaults": defaults_part,
    "dimensions": dimensions_part,
    "metrics": metrics_part,
    "parameters": parameters_part,
    "recognising": recognising_part,
    "settings": settings_part,
    "targets": targets_part,
    "tick": tick_part,
    "topics": topics_part,
}
"""What writes each part."""
