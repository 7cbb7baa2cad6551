"""A race: several algorithms with several seeds each, compared by their recommendations.

Each training has a run folder. Its recommendations after every five episodes are evaluated on seeds that no training
sees, and the mean scores are written to ``race.csv`` in the run folder. The final recommendation meets more episodes,
and its score in each is written to ``race_scores.csv``. A training with both files is not run again; if the numbers of
unseen seeds have changed, it is only evaluated again. A training that is not finished is resumed, so that a race
deletes nothing.
"""

from __future__ import annotations

import csv
import io
import os
import sys
import tempfile
import time
from collections.abc import Iterable, Sequence
from contextlib import suppress
from pathlib import Path
from statistics import mean

from tqdm import tqdm

from sarah.episode.evaluation import evaluate
from sarah.episode.workers import Workers
from sarah.errors import RunFolderError
from sarah.files import locked, read_text, replace_text
from sarah.number import number, whole_number
from sarah.recorded.folder import unreadable
from sarah.reports.race_entry import RACE_FILE, SCORES_FILE, Entry, RaceCurve, is_evaluated, read_curve
from sarah.runs.config_files import first_difference
from sarah.runs.run_folder import RunFolder
from sarah.training.recorder import EPISODES_PER_RECOMMENDATION
from sarah.training.train import simulated_episodes, train

TIME_FILE = "race_seconds.txt"
"""Name of the file in every run folder of a race that has the wall time of its training, in s."""
LOCK_FILE = "race.lock"
"""Name of the file in every run folder of a race that is locked while a race is at it."""


def race(entries: Sequence[Entry], workers: Workers, progress_bar: bool = False) -> list[RaceCurve]:
    """Run the trainings that are not complete, each in one process, and read the scores of all.

    A race that was interrupted goes on with the trainings that it was in. Several races in one folder share the work:
    each leaves out what another is at, and waits for that at its end.

    :param entries: trainings of the race; on a cluster, all workers must share the file system of their folders
    :param workers: workers that train
    :param progress_bar: whether to say how much there is to simulate, and show how many trainings are finished
    :raises RunFolderError: if a folder is not a run folder of a race, or has a training with other settings
    :raises ResumeError: if a training was made with other code or versions, and others are still to be made
    """
    for entry in entries:
        if entry.folder.exists():
            _check_settings(entry)
    if left := [entry for entry in entries if not is_evaluated(entry)]:
        for entry in entries:  # otherwise nothing of today comes into the table
            if entry.folder.exists():
                RunFolder(entry.folder).check_versions()
        progress_bar = progress_bar and sys.stderr is not None
        if progress_bar:
            print(_work(left), file=sys.stderr)
        with tqdm(total=len(left), unit=" trainings", disable=not progress_bar) as progress:
            for wait in (False, True):
                jobs = [(entry, workers.submit(run_entry, entry, wait)) for entry in left]
                for entry, job in jobs:
                    job.result()
                    if is_evaluated(entry):
                        progress.update()
                left = [entry for entry in left if not is_evaluated(entry)]
    return [read_curve(entry) for entry in entries]


def _work(left: Sequence[Entry]) -> str:
    """What there is to do, at most: a training goes on where it was, and what is alike is judged once."""
    unfinished = [entry for entry in left if not RunFolder(entry.folder, entry.config.task).is_finished]
    along = (entry.config.episodes // EPISODES_PER_RECOMMENDATION * entry.evaluations.along for entry in left)
    learning = sum(simulated_episodes(entry.config) for entry in unfinished)
    judging = sum(along) + sum(entry.evaluations.final for entry in left)
    return (
        f"{len(left)} trainings to go, with at most {learning} episodes together; "
        f"at most {judging} others judge what they recommend"
    )


def _check_settings(entry: Entry) -> None:
    """Refuse a folder that this training did not make."""
    try:
        there = RunFolder.open(entry.folder, unfinished=True, task=entry.config.task).config()
    except RunFolderError as error:
        raise RunFolderError(f"{entry.folder} is not of a race: name another folder") from error
    if difference := first_difference(entry.config, there):
        key, here, recorded = difference
        raise RunFolderError(f"{entry.folder} is a training with {key} {recorded}, not {here}: name another folder")


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
        return number(read_text(path).strip())
    except FileNotFoundError:
        return 0.0
    except (OSError, ValueError) as error:
        raise unreadable(path, error) from error


def _evaluate_recommendations(entry: Entry, run: RunFolder) -> None:
    """Write the scores of all recommendations, during the training and at its end."""
    config, count, names = entry.config, entry.evaluations, entry.config.task.parameter_names
    try:
        along = [
            (whole_number(row["episodes"]), tuple(number(row[name]) for name in names), count.along)
            for row in run.recommendations()
        ]
    except (KeyError, TypeError, ValueError) as error:
        raise unreadable(entry.folder, error) from error
    final, seconds = run.parameters(), _seconds(entry.folder / TIME_FILE)
    scores: dict[tuple[float, ...], list[float]] = {}
    means = []
    for episodes, parameters, evaluations in [*along, (config.episodes, final, count.final)]:
        known = scores.setdefault(parameters, [])
        if missing := range(len(known), evaluations):
            found = evaluate(config.task, parameters, config.episode, missing)
            known += (result.score for result in found.results)
        means.append((episodes, mean(known[:evaluations]), seconds, evaluations))
    _write_table(entry.folder / SCORES_FILE, ("seed", "score"), enumerate(scores[final]))
    _write_table(entry.folder / RACE_FILE, ("episodes", "score", "seconds", "evaluations"), means)


def _write_table(path: Path, columns: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(columns)
    writer.writerows(rows)
    replace_text(path, text.getvalue())
