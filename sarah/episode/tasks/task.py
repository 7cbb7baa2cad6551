"""A task: the parameters that are learned, and everything that only its episodes have."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from numbers import Real
from typing import Any, Generic, TypeVar

from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import Parameter
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.push import DrawnPush
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError, shortened

ConfigType = TypeVar("ConfigType", bound=EpisodeConfig)
ControllerParameters = tuple[SteppingParameters, BalanceParameters | None]
"""P1 to P5, and V1 to V4 unless the hips are locked."""


def no_push(config: Any, seed: int) -> DrawnPush | None:
    """Draw no push.

    :param config: settings of the episode
    :param seed: seed of the episode
    """
    return None


@dataclass(frozen=True, eq=False)
class Task(Generic[ConfigType]):
    """A task: what is learned.

    :param name: name on the command line, for ``--task``
    :param title: title of its training
    :param parameters: parameters that the agent chooses, in order
    :param episode: default settings of its episodes; their class adds the settings that only this task has
    :param controller_parameters: function that makes the controller's parameters from the chosen ones and the
        settings of the episode
    :param baseline: values of the parameters that learned ones are compared with
    :param baseline_label: name of the baseline on pages
    :param neutral: values of the parameters that do nothing, if there are any; chatter is judged against them
    :param draw_push: function that draws an episode's push from its settings and its seed
    """

    name: str
    title: str
    parameters: tuple[Parameter, ...]
    episode: ConfigType
    controller_parameters: Callable[[tuple[float, ...], Any], ControllerParameters]
    baseline: tuple[float, ...]
    baseline_label: str
    neutral: tuple[float, ...] | None = None
    draw_push: Callable[[Any, int], DrawnPush | None] = no_push

    @property
    def parameter_names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def has_push(self) -> bool:
        """Whether the episodes have a push."""
        return self.draw_push is not no_push

    def checked(self, values: Sequence[float], name: str = "parameters") -> tuple[float, ...]:
        """Check one value for every parameter, and convert them to floats.

        :param values: values in the order of :attr:`parameters`
        :param name: name of the values in messages
        :raises ConfigurationError: naming the first value that is not a number within its range
        """
        names = self.parameter_names
        if len(values) != len(names):
            raise ConfigurationError(
                f"{name} must be {len(names)} numbers ({names[0]} to {names[-1]}), not {len(values)}"
            )
        for parameter, value in zip(self.parameters, values, strict=True):
            low, high = parameter.low, parameter.high
            if not isinstance(value, Real) or isinstance(value, bool) or not low <= value <= high:
                raise ConfigurationError(
                    f"parameter {parameter.name} must be between {low:g} and {high:g}, not {shortened(value)}"
                )
        return tuple(map(float, values))

    def checked_config(self, config: EpisodeConfig) -> EpisodeConfig:
        """Check that settings are of this task's type, and return them.

        :param config: settings of episodes
        :raises ConfigurationError: if they are another task's settings
        """
        if type(config) is not type(self.episode):
            raise ConfigurationError(
                f"task {self.name!r} takes settings of type {type(self.episode).__name__}, not {type(config).__name__}"
            )
        return config

    def config_of(self, config: EpisodeConfig, **changes: Any) -> ConfigType:
        """Settings of another task's episodes as this task's; fields that only this task has are defaults.

        :param config: settings of any task's episodes
        :param changes: new values of some fields, by name
        """
        shared = {name: getattr(config, name) for name in vars(self.episode) if hasattr(config, name)}
        return type(self.episode)(**{**vars(self.episode), **shared, **changes})
