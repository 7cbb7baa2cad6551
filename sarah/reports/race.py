"""A race: several algorithms with several seeds each, compared by their recommendations.

Each training has a run folder. Its recommendations after every five episodes are evaluated on seeds that no training
sees, and the scores are written to ``race.csv`` in the run folder. A training with a ``race.csv`` is not run again; if
the number of unseen seeds has changed, it is only evaluated again. A training without one is resumed, so that a race
deletes nothing.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import os
import tempfile
import time
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from sarah.episode.evaluation import evaluate
from sarah.episode.workers import Workers
from sarah.errors import RunFolderError
from sarah.files import locked, read_lines, read_text, replace_text
from sarah.number import finite_number, whole_number
from sarah.runs.agent_settings import settings_of
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import first_difference
from sarah.runs.origin import check_origin
from sarah.runs.run_episodes import LONGEST_REASON
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train

RACE_FILE = "race.csv"
"""Name of the file in every run folder of a race: scores of its recommendations, during the training and at its end."""
TIME_FILE = "race_seconds.txt"
"""Name of the file in every run folder of a race that has the wall time of its training, in s."""
LOCK_FILE = "race.lock"
"""Name of the file in every run folder of a race that is locked while a race is at it."""


@dataclass(frozen=True)
class Entry:
    """One training of a race.

    :param config: settings of the training
    :param folder: path of its run folder
    :param evaluations: number of unseen seeds on which every recommendation is evaluated
    """

    config: TrainingConfig
    folder: Path
    evaluations: int


@dataclass(frozen=True)
class RaceCurve:
    """The scores of one training's recommendations.

    :param algo: name of the algorithm
    :param episodes: numbers of episodes before each evaluation, rising; the last one is the budget
    :param scores: mean score of each evaluation over the unseen seeds, of the same length
    :param seconds: wall time of the training, without the evaluations, in s; of all its parts, if it was interrupted
    """

    algo: str
    episodes: tuple[int, ...]
    scores: tuple[float, ...]
    seconds: float


def race(entries: Sequence[Entry], workers: Workers) -> list[RaceCurve]:
    """Run the trainings that are not complete, each in one process, and read the scores of all.

    A race that was interrupted goes on with the trainings that it was in. Several races in one folder share the work:
    each leaves out what another is at, and waits for that at its end.

    :param entries: trainings of the race; on a cluster, all workers must share the file system of their folders
    :param workers: workers that train
    :raises RunFolderError: if a folder is not a run folder of a race, or has a training with other settings
    :raises ResumeError: if a training was made with other code or versions, and others are still to be made
    """
    for entry in entries:
        if entry.folder.exists():
            _check_settings(entry)
    if not all(is_evaluated(entry) for entry in entries):  # otherwise nothing of today comes into the table
        for entry in entries:
            if entry.folder.exists():
                check_origin(RunFolder(entry.folder).journal_path, entry.config)
    for wait in (False, True):
        jobs = [workers.submit(run_entry, entry, wait) for entry in entries if not is_evaluated(entry)]
        for job in jobs:
            job.result()
    return [read_curve(entry) for entry in entries]


def _check_settings(entry: Entry) -> None:
    """Refuse a folder that this training did not make."""
    try:
        there = RunFolder.resumable(entry.folder, entry.config.task).config()
    except RunFolderError as error:
        raise RunFolderError(f"{entry.folder} is not of a race: name another folder") from error
    if difference := first_difference(entry.config, there):
        key, here, recorded = difference
        raise RunFolderError(f"{entry.folder} is a training with {key} {recorded}, not {here}: name another folder")


def is_run(entry: Entry) -> bool:
    """Whether a training and an evaluation of it are complete.

    :param entry: training of the race
    """
    return (entry.folder / RACE_FILE).exists()


def is_evaluated(entry: Entry) -> bool:
    """Whether a training is complete, and evaluated on as many unseen seeds as the race asks for.

    :param entry: training of the race
    """
    return is_run(entry) and _rows(entry)[0].get("evaluations") == str(entry.evaluations)


def run_entry(entry: Entry, wait: bool = True) -> None:
    """Train, and evaluate every recommendation; what another race has done already is not done again.

    :param entry: training of the race
    :param wait: whether to wait while another race is at this training, and not to leave it out
    :raises RunFolderError: if the training is in use by something else than a race, or cannot be resumed here
    """
    run = _run_folder(entry)
    with locked(entry.folder / LOCK_FILE, wait) as is_ours:
        if is_ours and not is_evaluated(entry):
            if not run.is_finished:
                _train(entry, run)
            _evaluate_recommendations(entry, run)


def _run_folder(entry: Entry) -> RunFolder:
    """The run folder of a training. It appears as a whole: a race that is killed leaves one that can be resumed."""
    if not entry.folder.exists():
        entry.folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=".begun-", dir=entry.folder.parent) as begun:
            RunFolder.create(Path(begun) / "run", entry.config)
            with suppress(OSError):  # another race was quicker
                os.rename(Path(begun) / "run", entry.folder)
    _check_settings(entry)
    return RunFolder(entry.folder, entry.config.task)


def _train(entry: Entry, run: RunFolder) -> None:
    """Train, or go on training, and note the wall time of this and of all earlier parts after every episode."""
    path = entry.folder / TIME_FILE
    earlier, start = _seconds(path), time.perf_counter()

    def note_time() -> bool:
        replace_text(path, f"{earlier + time.perf_counter() - start}\n")
        return False  # the training goes on

    train(entry.config, run, interrupted=note_time)
    note_time()


def _seconds(path: Path) -> float:
    """Wall time of a training so far, in s."""
    try:
        return finite_number(read_text(path).strip())
    except FileNotFoundError:
        return 0.0
    except (OSError, ValueError) as error:
        raise _unreadable(path, error) from error


def _evaluate_recommendations(entry: Entry, run: RunFolder) -> None:
    """Write the scores of all recommendations, during the training and at its end."""
    config, names = entry.config, entry.config.task.parameter_names
    seconds = read_curve(entry).seconds if is_run(entry) else _seconds(entry.folder / TIME_FILE)
    try:
        along = [
            (whole_number(row["episodes"]), tuple(finite_number(row[name]) for name in names))
            for row in run.recommendations()
        ]
    except (KeyError, TypeError, ValueError) as error:
        raise _unreadable(entry.folder, error) from error
    known: dict[tuple[float, ...], float] = {}
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(("episodes", "score", "seconds", "evaluations"))
    for episodes, parameters in [*along, (config.episodes, run.parameters())]:
        if parameters not in known:
            evaluation = evaluate(config.task, parameters, config.episode, range(entry.evaluations))
            known[parameters] = evaluation.mean("score")
        writer.writerow((episodes, known[parameters], seconds, entry.evaluations))
    replace_text(entry.folder / RACE_FILE, text.getvalue())


def read_curve(entry: Entry) -> RaceCurve:
    """Read the scores that :func:`run_entry` wrote.

    :param entry: training that is complete
    :raises RunFolderError: if they cannot be read
    """
    rows = _rows(entry)
    try:
        return RaceCurve(
            entry.config.algo,
            tuple(whole_number(row["episodes"]) for row in rows),
            tuple(finite_number(row["score"]) for row in rows),
            finite_number(rows[0]["seconds"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise _unreadable(entry.folder / RACE_FILE, error) from error


def _rows(entry: Entry) -> list[dict[str, str]]:
    """Rows of the race's table in a run folder: at most one for each episode, and one for the end."""
    path = entry.folder / RACE_FILE
    try:
        rows = list(csv.DictReader(read_lines(path, entry.config.episodes + 2)))
    except (OSError, csv.Error) as error:
        raise _unreadable(path, error) from error
    if not rows:
        raise _unreadable(path, ValueError("it has no rows"))
    return rows


def _unreadable(path: Path, error: Exception) -> RunFolderError:
    reason = getattr(error, "strerror", None) or repr(error)
    return RunFolderError(f"{path} cannot be read: {reason[:LONGEST_REASON]}")


def entries_of(
    algorithms: Sequence[str], seeds: Sequence[int], base: TrainingConfig, evaluations: int, folder: Path
) -> list[Entry]:
    """Entries of a race: every algorithm with every seed.

    :param algorithms: names of the algorithms
    :param seeds: seeds of the trainings
    :param base: settings that all trainings share
    :param evaluations: number of unseen seeds on which every recommendation is evaluated
    :param folder: folder for the run folders
    """
    return [
        Entry(
            dataclasses.replace(base, algo=algo, agent=settings_of(algo)(), seed=seed),
            folder / f"{algo}-s{seed}",
            evaluations,
        )
        for seed in seeds
        for algo in algorithms
    ]
