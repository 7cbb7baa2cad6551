"""What the functions of a task return, checked: those of somebody's file can raise anything, and return anything."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from sarah.control.hip_law import BalanceParameters
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.ending import is_ending
from sarah.episode.push import DrawnPush
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task
from sarah.episode.tasks.task import ControllerParameters
from sarah.episode.tasks.task_file import mistake
from sarah.episode.tick import Tick
from sarah.errors import SarahError, TaskError, shortened
from sarah.number import is_finite, plain

ENDINGS_OF_EPISODES = ("time_limit", "diverged")
"""Endings that no task can claim: the episode itself finds them."""


def push_of(task: Task, config: EpisodeConfig, seed: int) -> DrawnPush | None:
    """Draw an episode's push.

    :param task: task of the episode
    :param config: settings of the episode
    :param seed: seed of the episode
    :raises TaskError: naming the mistake of a function in a file, here and below
    """
    drawn = _asked(task, task.draw_push, config, seed)
    if drawn is None or isinstance(drawn, DrawnPush):
        return drawn
    raise _wrong(task, "draw_push must return a DrawnPush or None", drawn)


def disturbances_of(spec: EpisodeSpec) -> tuple[float, ...] | None:
    """Disturbances of an episode; ``None`` if its task names none.

    :param spec: specification of the episode
    """
    task = spec.task
    if task.disturbances is None:
        return None
    given = _asked(task, task.disturbances, spec)
    numbers = plain(given)
    if isinstance(numbers, (list, tuple)) and all(map(is_finite, numbers)):
        return tuple(float(plain(number)) for number in numbers)
    raise _wrong(task, "disturbances must return a tuple of finite numbers", given)


def check_as_many(task: Task, disturbances: Sequence[float], before: Sequence[Sequence[float]]) -> None:
    """Refuse disturbances of an episode that are more or fewer than those of the episodes before.

    :param task: task of the episodes
    :param disturbances: disturbances of the episode
    :param before: disturbances of the episodes before
    """
    if before and len(disturbances) != len(before[0]):
        raise TaskError(
            f"{task.reference}: disturbances must be as many numbers in every episode, "
            f"{len(before[0])}, not {len(disturbances)}"
        )


def controller_of(task: Task, parameters: tuple[float, ...], config: EpisodeConfig) -> ControllerParameters:
    """Make the controller's parameters.

    :param task: task of the episode
    :param parameters: values of the task's parameters, in order
    :param config: settings of the episode
    """
    made = _asked(task, task.controller_parameters, task.box.checked(parameters), config)
    if isinstance(made, tuple) and len(made) == 2:
        stepping, balance = made
        kinds = isinstance(stepping, SteppingParameters) and isinstance(balance, BalanceParameters | None)
        if kinds and all(map(is_finite, (*vars(stepping).values(), *vars(balance or stepping).values()))):
            return stepping, balance
    raise _wrong(
        task, "controller_parameters must return finite SteppingParameters, and BalanceParameters or None", made
    )


def reward_of(task: Task, tick: Tick, config: EpisodeConfig) -> float:
    """Reward per second at the end of a control tick.

    :param task: task of the episode
    :param tick: what is known then
    :param config: settings of the episode
    """
    reward = _asked(task, task.reward, tick, config)
    number = plain(reward)
    if not is_finite(number):
        raise _wrong(task, "its reward must be a finite number", reward)
    return float(number)


def ending_of(task: Task, tick: Tick, config: EpisodeConfig) -> str | None:
    """How a task ends the episode now; ``None`` if it goes on.

    :param task: task of the episode
    :param tick: what is known at the end of a control tick
    :param config: settings of the episode
    """
    ending: str | None = _asked(task, task.ending, tick, config)
    if ending is not None and (not is_ending(ending) or ending in ENDINGS_OF_EPISODES):
        raise _wrong(task, "an ending must be a short name of its own such as 'jumped'", ending)
    return ending


def _asked(task: Task, function: Callable[..., Any], *arguments: Any) -> Any:
    """What a function of a task returns; a mistake in a file is named with its line."""
    try:
        return function(*arguments)
    except SarahError:
        raise
    except (Exception, SystemExit) as error:
        if task.file is None:
            raise
        raise TaskError(mistake(task.file.name, error)) from error


def _wrong(task: Task, rule: str, returned: object) -> TaskError:
    return TaskError(f"{task.reference}: {rule}, not {shortened(returned)}")
