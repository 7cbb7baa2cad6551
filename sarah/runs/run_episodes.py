"""The episodes of a run folder, or of given parameters, from which a command chooses one."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from sarah.episode.ending import ending_words
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, TASKS, Task
from sarah.errors import ConfigurationError, RunFolderError
from sarah.number import number, whole_number

if TYPE_CHECKING:
    from sarah.runs.run_folder import RunFolder
    from sarah.runs.run_record import RunRecord


@dataclass(frozen=True)
class RunEpisode:
    """An episode to look at.

    :param name: name on the command line, for ``--which``
    :param label: name in the page's list
    :param spec: specification of the episode
    :param score: score that the run folder has for it; ``None`` if it was not simulated there
    :param recorded: function that simulates it with a trace, if it is more than its specification says: a window of a
        robot that goes on
    :param next_name: name of the episode that goes on where this one ends, if there is one
    """

    name: str
    label: str
    spec: EpisodeSpec
    score: float | None = None
    recorded: Callable[[], EpisodeResult] | None = None
    next_name: str | None = None

    def of(self, spec: EpisodeSpec) -> RunEpisode:
        """Make the same choice of another specification; what the run folder knows is of its own one only.

        :param spec: specification of the episode
        """
        return self if spec == self.spec else replace(self, spec=spec, score=None, recorded=None, next_name=None)


def learned_episode(run: RunRecord) -> RunEpisode:
    """Episode of a training's learned parameters, with seed 0.

    :param run: record of the training, which is finished
    :raises RunFolderError: if the learned parameters cannot be read
    """
    spec = EpisodeSpec(run.learned, 0, run.config.task, run.config.episode)
    return RunEpisode("learned", "learned parameters · seed 0", spec)


def episodes_of_run(run: RunFolder) -> list[RunEpisode]:
    """Episodes of a training: its learned parameters, its best episode, and then all of its episodes.

    :param run: run folder of the training, which need not be finished
    :raises RunFolderError: if a row of ``episodes.csv`` cannot be read, or if there is no episode
    """
    from sarah.runs.run_record import RunRecord  # numbers and names need no folder

    record = RunRecord(run)
    task = record.config.task
    shown = [learned_episode(record)] if run.is_finished else []
    simulated = []
    for row in record.episodes:
        with record.naming_folder():
            parameters = tuple(number(row[name]) for name in task.parameter_names)
            spec = EpisodeSpec(parameters, whole_number(row["seed"]), task, record.config.episode)
            score, ending = number(row["score"]), ending_words(row["termination"])
            label = f"episode {row['index']} · score {score:.2f} · {ending}"
            simulated.append(RunEpisode(row["index"], label, spec, score))
    if simulated:
        best = max(simulated, key=lambda episode: -math.inf if episode.score is None else episode.score)
        shown.append(RunEpisode("best", f"best: {best.label}", best.spec, best.score))
    if not shown:
        raise RunFolderError(f"{run.path} has no episodes to show yet")
    return shown + simulated


def episode_of_parameters(parameters: Sequence[float], task: Task[Any] | None = None) -> RunEpisode:
    """Episode of given parameters, with seed 0.

    :param parameters: values of a task's parameters; or P1 to P5 and V1 to V4 together, for the task balance
    :param task: task of the parameters; by default that of this package which has so many
    :raises ConfigurationError: if the number of parameters is that of no task, or if one is not allowed
    """
    all_of_both = len(STEPPING.parameters) + len(BALANCE.parameters)
    takes_both = task in (None, BALANCE)
    if takes_both and len(parameters) == all_of_both:
        stepping = STEPPING.box.checked(parameters[: len(STEPPING.parameters)])
        label = f"P and V = {', '.join(f'{value:g}' for value in parameters)} · seed 0"
        config = BALANCE.config_of(BALANCE.episode, stepping=stepping)
        spec = EpisodeSpec(tuple(parameters[len(stepping) :]), 0, BALANCE, config)
        return RunEpisode("given", label, spec)
    tasks = TASKS.values() if task is None else (task,)
    for task in tasks:
        if len(parameters) == len(task.parameter_names):
            label = f"{task.parameter_names[0][0]} = {', '.join(f'{value:g}' for value in parameters)} · seed 0"
            return RunEpisode("given", label, EpisodeSpec(tuple(parameters), 0, task))
    counts = " or ".join(
        f"{len(task.parameter_names)} numbers ({task.parameter_names[0]} to {task.parameter_names[-1]})"
        for task in tasks
    )
    both = f" or all {all_of_both}" if takes_both else ""
    raise ConfigurationError(f"parameters must be {counts}{both}, not {len(parameters)}")


def choose_episode(episodes: list[RunEpisode], name: str | None) -> RunEpisode:
    """Find an episode by its name.

    :param episodes: episodes to choose from
    :param name: ``learned``, ``best`` or the index of an episode; the first one if ``None``
    :raises ConfigurationError: if there is no such episode
    """
    if name is None:
        return episodes[0]
    for episode in episodes:
        if episode.name == name:
            return episode
    words = [episode.name for episode in episodes if not episode.name.isdigit()]
    simulated = [episode.name for episode in episodes if episode.name.isdigit()]
    numbers = [f"{simulated[0]} to {simulated[-1]}"] if simulated else []
    raise ConfigurationError(f"unknown episode {name!r} (allowed: {', '.join(words + numbers)})")
