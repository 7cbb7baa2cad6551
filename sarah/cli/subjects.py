"""What a command looks at: a folder, numbers, or the name of shipped parameters."""

from __future__ import annotations

import os
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task
from sarah.errors import ConfigurationError, RunFolderError, shortened, unknown_name
from sarah.number import number
from sarah.runs.kinds import RECOGNITION, SESSION

LOG_SUFFIX = ".mcap"
"""Ending of the name of a log."""

if TYPE_CHECKING:
    from sarah.runs.run_episodes import RunEpisode


def is_shipped(subject: str) -> bool:
    """Whether a subject is the name of shipped parameters; a run folder of that name goes before.

    :param subject: path of a run folder, numbers separated by commas, or the name of shipped parameters
    """
    return subject in PARAMETER_SETS and not Path(subject).is_dir()


def is_log(subject: str) -> bool:
    """Whether a subject is the log of a robot.

    :param subject: what an argument names
    """
    return subject.endswith(LOG_SUFFIX) and Path(subject).is_file()


def check_played(subject: str, logged: EpisodeSpec, wanted: EpisodeSpec | None) -> None:
    """Refuse settings for a log, which is played as it is.

    :param subject: what an argument names
    :param logged: specification of the episode that it is
    :param wanted: specification with the settings of the options; ``None`` if it is another one in any case
    """
    if is_log(subject) and wanted != logged:
        raise ConfigurationError("a log is played as it is: leave settings of episodes and --seed out")


def is_there(subject: str) -> bool:
    """Whether there are settings to begin from; what there is not is reported later.

    :param subject: what an argument names
    """
    is_run = Path(subject).joinpath("config.yaml").is_file() or any(
        kind.owns(Path(subject)) for kind in (SESSION, RECOGNITION)
    )
    return (
        subject in PARAMETER_SETS
        or is_run
        or is_log(subject)
        or ("," in subject and subject.strip(" +-.")[:1].isdigit())
    )


def episodes_of(subject: str, which: str | None, task: Task[Any] | None) -> tuple[list[RunEpisode], RunEpisode]:
    """Episodes of what a command looks at, and the one to show.

    :param subject: path of a run folder, numbers separated by commas, or the name of shipped parameters
    :param which: episode of the run folder: ``learned``, ``best`` or an index; ``None`` for the first of these that
        exists
    :param task: task of the numbers, or of a run folder whose task is that of a file
    :raises ConfigurationError: if there is no such subject or episode
    """
    from sarah.runs.run_episodes import RunEpisode, choose_episode, episode_of_parameters, episodes_of_run

    if SESSION.owns(Path(subject)):
        from sarah.runs.session_episodes import episodes_of_session

        episodes = episodes_of_session(Path(subject))
        return episodes, choose_episode(episodes, which)
    if RECOGNITION.owns(Path(subject)):
        from sarah.recognition.folder import RecognitionFolder

        episodes = [RecognitionFolder.open(Path(subject)).best()]
        return episodes, choose_episode(episodes, which)
    if Path(subject).is_dir():
        from sarah.runs.run_folder import RunFolder

        episodes = episodes_of_run(RunFolder.open(Path(subject), unfinished=True, task=task))
        return episodes, choose_episode(episodes, which)
    if which is not None:
        raise ConfigurationError("--which is for a run folder")
    if is_log(subject):
        logged = _logged_episode(Path(subject))
        return [logged], logged
    if subject in PARAMETER_SETS:
        given = RunEpisode(subject, f"{subject} · seed 0", PARAMETER_SETS[subject].spec)
        if task not in (None, given.spec.task):
            raise ConfigurationError(
                f"{subject!r} are parameters of task {given.spec.task.name!r}: give others, or leave --task out"
            )
    elif subject.strip(" +-.")[:1].isdigit():
        given = episode_of_parameters(numbers(subject), task)
    elif os.sep in subject:
        raise RunFolderError(f"there is neither a run folder nor a log {shortened(subject)}")
    else:
        names = unknown_name("name of parameters", subject, PARAMETER_SETS)
        raise ConfigurationError(
            f"{shortened(subject)} is neither a run folder, nor numbers separated by commas: {names}"
        )
    return [given], given


def _logged_episode(path: Path) -> RunEpisode:
    """The motion of a logged robot, as an episode to look at."""
    from sarah.logs.played import played, spec_of_log
    from sarah.runs.run_episodes import RunEpisode

    spec = spec_of_log(path)
    return RunEpisode(path.name, f"log {path.name}", spec, recorded=cache(partial(played, path, spec.robot)))


def episode_of(subject: str, which: str | None, task: Task[Any] | None) -> RunEpisode:
    """What :func:`episodes_of` would show, found without reading the other episodes of a run folder if possible.

    :param subject: path of a run folder, numbers separated by commas, or the name of shipped parameters
    :param which: episode of the run folder, as there
    :param task: task, as there
    :raises ConfigurationError: if there is no such subject or episode
    """
    is_other = SESSION.owns(Path(subject)) or RECOGNITION.owns(Path(subject))
    if Path(subject).is_dir() and not is_other and which in (None, "learned"):
        from sarah.runs.run_episodes import learned_episode
        from sarah.runs.run_folder import RunFolder
        from sarah.runs.run_record import RunRecord

        run = RunFolder.open(Path(subject), unfinished=True, task=task)
        if run.is_finished:
            return learned_episode(RunRecord(run))
    return episodes_of(subject, which, task)[1]


def learned_of(subject: str, task: Task[Any] | None) -> tuple[EpisodeSpec, str | None]:
    """Episode of learned or given parameters, and name of what learned them; ``None`` for given and shipped ones.

    :param subject: path of a run folder, numbers separated by commas, or the name of shipped parameters
    :param task: task of the numbers, or of a run folder whose task is that of a file
    :raises ConfigurationError: if there is no such subject
    :raises RunFolderError: if the folder has no learned parameters
    """
    if SESSION.owns(Path(subject)):
        from sarah.runs.session_episodes import learned_of_session
        from sarah.runs.session_folder import SessionFolder

        return learned_of_session(Path(subject)).spec, SessionFolder.open(Path(subject)).spec().learner
    if RECOGNITION.owns(Path(subject)):
        from sarah.recognition.folder import RecognitionFolder

        return RecognitionFolder.open(Path(subject)).best().spec, "one set for all"
    if Path(subject).is_dir():
        from sarah.runs.run_episodes import learned_episode
        from sarah.runs.run_folder import RunFolder
        from sarah.runs.run_record import RunRecord

        run = RunRecord(RunFolder.open(Path(subject), task=task))
        return learned_episode(run).spec, run.config.algo
    return episode_of(subject, None, task).spec, None


def numbers(text: str) -> tuple[float, ...]:
    """Read parameters, as numbers that are separated by commas.

    :param text: text that a user gave
    :raises ConfigurationError: if one of them is not a number
    """
    try:
        return tuple(number(value.strip(" ")) for value in text.split(","))
    except ValueError:
        raise ConfigurationError(f"parameters must be numbers separated by commas, not {shortened(text)}") from None
