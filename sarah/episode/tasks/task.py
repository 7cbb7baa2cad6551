"""A task: the parameters that are learned, and everything that only its episodes have."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import Box, Parameter
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.disturbances import drawn_disturbances
from sarah.episode.ending import paper_ending
from sarah.episode.push import DrawnPush, PushedConfig, push_of_settings
from sarah.episode.result import EpisodeResult
from sarah.episode.reward import equation_2
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tick import Tick
from sarah.errors import ConfigurationError, shortened
from sarah.number import is_number, plain

ConfigType = TypeVar("ConfigType", bound=EpisodeConfig)
ControllerParameters = tuple[SteppingParameters, BalanceParameters | None]
"""P1 to P5, and V1 to V4 unless the hips are locked."""
RESERVED = frozenset({"index", "seed", "episodes", "return", "x", "y", *EpisodeResult.__dataclass_fields__})
"""Names of columns in the tables of a run folder, which no parameter may have."""
LONGEST_TEXT = 200
"""Length of the longest text about a task or a parameter, in characters."""
LARGEST = 1e6
"""Largest end of a parameter's range."""
NARROW = 2.0**-20
"""Width of a range in which 32-bit numbers tell hardly any values apart, as a share of the larger end."""
SHORTEST = 0.01
"""Shortest length scale of a parameter, and reciprocal of the longest."""


def _is_plain(text: object) -> bool:
    """Whether a text can stand in tables and figures, and on a terminal."""
    return isinstance(text, str) and text.isprintable() and "$" not in text and len(text) <= LONGEST_TEXT


@dataclass(frozen=True)
class TaskFile:
    """A file that a task was loaded from.

    :param name: name of the file, without its folder
    :param attribute: name of the task in the file
    :param text: text of the file
    """

    name: str
    attribute: str
    text: str

    def __post_init__(self) -> None:
        """Refuse names that no file and no task can have."""
        if not _is_plain(self.name) or "/" in self.name or not self.name.endswith(".py"):
            raise ConfigurationError(
                f"a task's file must have a plain name that ends in .py, not {shortened(self.name)}"
            )
        if not isinstance(self.attribute, str) or not self.attribute.isidentifier() or not _is_plain(self.attribute):
            raise ConfigurationError(f"a task in a file must be a name, not {shortened(self.attribute)}")

    @property
    def reference(self) -> str:
        """How the command line names the task, such as ``my_task.py:JUMP``."""
        return f"{self.name}:{self.attribute}"

    @property
    def digest(self) -> str:
        """First twelve hexadecimal digits of the text's SHA-256, which tell it from any other text."""
        return hashlib.sha256(self.text.encode()).hexdigest()[:12]


@dataclass(frozen=True, eq=False)
class Task(Generic[ConfigType]):
    """A task: what is learned, and how it is judged. All its functions are pure: they depend on their arguments only.

    :param name: name, for pages and run folders: letters, digits, ``-`` and ``_``
    :param title: title of its training
    :param parameters: parameters that the agent chooses, in order
    :param episode: default settings of its episodes; their class adds settings, such as those of a push
    :param controller_parameters: function that makes the controller's parameters from the chosen ones and the
        settings of the episode
    :param baseline: values of the parameters that learned ones are compared with
    :param baseline_label: name of the baseline on pages
    :param neutral: values of the parameters that do nothing, if there are any; chatter is judged against them
    :param reward: function that returns the reward per second, from a :class:`~sarah.episode.tick.Tick` and the
        settings of the episode; by default the paper's equation 2
    :param best_reward: reward per second whose score is 1; by default the highest that equation 2 gives
    :param ending: function that returns how the episode ends now, or ``None`` if it goes on, from the same arguments;
        by default the paper's box and oscillation, and a fall. The time limit always ends an episode
    :param must_step: whether a training recommends only robots that step by their sensors
    :param draw_push: function that draws an episode's push from its settings and its seed
    :param disturbances: function that returns what an episode was subjected to and its parameters did not choose, from
        its :class:`~sarah.episode.spec.EpisodeSpec`: finite numbers, as many for every episode. A training takes what
        they explain out of the returns. By default push, friction, servos, slope and masses; ``None`` for none
    :param file: file that it was loaded from; nothing for a task of this package or of a script
    """

    name: str
    title: str
    parameters: tuple[Parameter, ...]
    episode: ConfigType
    controller_parameters: Callable[[tuple[float, ...], Any], ControllerParameters]
    baseline: tuple[float, ...]
    baseline_label: str = "baseline"
    neutral: tuple[float, ...] | None = None
    reward: Callable[[Tick, Any], float] = equation_2
    best_reward: float | None = None
    ending: Callable[[Tick, Any], str | None] = paper_ending
    must_step: bool = True
    draw_push: Callable[[Any, int], DrawnPush | None] = push_of_settings
    disturbances: Callable[[Any], Sequence[float]] | None = drawn_disturbances
    file: TaskFile | None = None

    def __post_init__(self) -> None:
        """Refuse names and boxes that cannot be used.

        :raises ConfigurationError: naming what is not allowed
        """
        if not re.fullmatch(r"[A-Za-z][\w-]{0,39}", str(self.name), re.ASCII):
            raise ConfigurationError(f"a task's name must be letters, digits, - and _, not {shortened(self.name)}")
        if not isinstance(self.episode, EpisodeConfig):
            raise ConfigurationError(f"episode of task {self.name!r} must be settings of episodes")
        object.__setattr__(self, "must_step", plain(self.must_step))
        if not _is_plain(self.title) or not _is_plain(self.baseline_label) or not isinstance(self.must_step, bool):
            raise ConfigurationError(f"title and baseline_label of task {self.name!r} must be plain texts")
        names = self.parameter_names
        for name, parameter in zip(names, self.parameters, strict=True):
            if not re.fullmatch(r"[A-Za-z]\w{0,39}", str(name), re.ASCII) or name in RESERVED or names.count(name) > 1:
                raise ConfigurationError(
                    f"parameter {shortened(name)} of task {self.name!r} must have a name of its own: letters and "
                    f"digits, and none of {', '.join(sorted(RESERVED))}"
                )
            if not all(map(_is_plain, (parameter.unit, parameter.meaning, parameter.paper))):
                raise ConfigurationError(f"unit and meaning of parameter {name} must be plain texts, without $")
            if not all(map(is_number, (parameter.low, parameter.high))) or (
                not -LARGEST <= parameter.low < parameter.high <= LARGEST
            ):
                ends = f"{shortened(parameter.low)} and {shortened(parameter.high)}"
                raise ConfigurationError(f"ends of parameter {name} must be in rising order, not {ends}")
            if parameter.width <= NARROW * max(abs(parameter.low), abs(parameter.high)):
                ends = f"{parameter.low!r} and {parameter.high!r}"
                raise ConfigurationError(f"ends of parameter {name} are too near to each other to learn it: {ends}")
            if not is_number(parameter.length_scale) or not SHORTEST <= parameter.length_scale <= 1.0 / SHORTEST:
                allowed = f"a number from {SHORTEST:g} to {1.0 / SHORTEST:g}, not {shortened(parameter.length_scale)}"
                raise ConfigurationError(f"length_scale of parameter {name} must be {allowed}")
        if not names:
            raise ConfigurationError(f"task {self.name!r} needs at least one parameter")
        object.__setattr__(self, "baseline", self.box.checked(self.baseline, "baseline"))
        if self.neutral is not None:
            object.__setattr__(self, "neutral", self.box.checked(self.neutral, "neutral"))
        object.__setattr__(self, "best_reward", plain(self.best_reward))
        if self.best_reward is not None and not (is_number(self.best_reward) and 0.0 < self.best_reward <= LARGEST):
            raise ConfigurationError(f"best_reward must be above 0, not {shortened(self.best_reward)}")

    def __repr__(self) -> str:
        """Name and origin, in short."""
        return f"Task({self.identity})"

    @property
    def reference(self) -> str:
        """How the command line names the task: its name, or file and name such as ``my_task.py:JUMP``."""
        return self.name if self.file is None else self.file.reference

    @property
    def identity(self) -> str:
        """What tells this task from any other: its name, and a hash of the file that it was loaded from."""
        return self.name if self.file is None else f"{self.file.attribute} ({self.file.digest})"

    @property
    def box(self) -> Box:
        """Ranges of the parameters together."""
        return Box(self.parameters)

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return self.box.names

    @property
    def has_push(self) -> bool:
        """Whether the episodes have a push."""
        return isinstance(self.episode, PushedConfig) or self.draw_push is not push_of_settings

    def checked_config(self, config: EpisodeConfig, may_be_pushed: bool = False) -> EpisodeConfig:
        """Check that settings are of this task's type, and return them.

        :param config: settings of episodes
        :param may_be_pushed: whether to accept a push where the task itself has none
        :raises ConfigurationError: if they are another task's settings
        """
        own = type(self.episode)
        if type(config) is not own and not (may_be_pushed and (own, type(config)) == (EpisodeConfig, PushedConfig)):
            raise ConfigurationError(
                f"task {self.name!r} takes settings of type {type(self.episode).__name__}, not {type(config).__name__}"
            )
        return config

    def config_of(self, config: EpisodeConfig, **changes: Any) -> ConfigType:
        """Settings of another task's episodes as this task's; fields that only this task has are defaults.

        :param config: settings of any task's episodes
        :param changes: new values of some fields, by name
        """
        own = vars(self.episode.for_robot(config.dimensions))
        shared = {name: getattr(config, name) for name in own if hasattr(config, name)}
        return type(self.episode)(**{**own, **shared, **changes})
