"""One training of a race: its run folder, and the scores that judge its recommendations there."""

from __future__ import annotations

import csv
import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import mean

from sarah.files import read_lines
from sarah.number import number, whole_number
from sarah.recorded.folder import unreadable
from sarah.reports.judging import MOST_EVALUATIONS, Evaluations
from sarah.runs.agent_settings import settings_of
from sarah.runs.config import TrainingConfig

RACE_FILE = "race.csv"
"""Name of the file in every run folder of a race: mean scores of its recommendations, along the way and at its end."""
SCORES_FILE = "race_scores.csv"
"""Name of the file in every run folder of a race: score of its final recommendation in each judging episode."""


@dataclass(frozen=True)
class Entry:
    """One training of a race.

    :param config: settings of the training
    :param folder: path of its run folder
    :param evaluations: numbers of unseen seeds on which its recommendations are evaluated
    """

    config: TrainingConfig
    folder: Path
    evaluations: Evaluations


@dataclass(frozen=True)
class RaceCurve:
    """The scores of one training's recommendations.

    :param algo: name of the algorithm
    :param episodes: numbers of episodes before each evaluation, rising; the last one is the budget
    :param scores: mean score of each evaluation over the episodes along the way, of the same length
    :param final: score of the final recommendation in every judging episode; the first are those along the way
    :param along: number of episodes along the way
    :param seconds: wall time of the training, without the evaluations, in s; of all its parts, if it was interrupted
    """

    algo: str
    episodes: tuple[int, ...]
    scores: tuple[float, ...]
    final: tuple[float, ...]
    along: int
    seconds: float


def entries_of(
    algorithms: Sequence[str], seeds: Sequence[int], base: TrainingConfig, evaluations: Evaluations, folder: Path
) -> list[Entry]:
    """Entries of a race: every algorithm with every seed.

    :param algorithms: names of the algorithms
    :param seeds: seeds of the trainings
    :param base: settings that all trainings share
    :param evaluations: numbers of unseen seeds on which the recommendations are evaluated
    :param folder: folder for the run folders
    """
    return [
        Entry(
            dataclasses.replace(
                base, algo=algo, agent=base.agent if algo == base.algo else settings_of(algo)(), seed=seed
            ),
            folder / f"{algo}-s{seed}",
            evaluations,
        )
        for seed in seeds
        for algo in algorithms
    ]


def is_evaluated(entry: Entry) -> bool:
    """Whether a training is complete, and evaluated on as many unseen seeds as the race asks for.

    :param entry: training of the race
    :raises RunFolderError: if its scores cannot be read
    """
    if not (entry.folder / RACE_FILE).exists():
        return False
    *along, final = [row.get("evaluations") for row in _rows(entry)]
    if final != str(entry.evaluations.final) or any(count != str(entry.evaluations.along) for count in along):
        return False
    return len(_scores(entry)) >= entry.evaluations.final  # fewer, if an evaluation was cut between the two files


def read_curve(entry: Entry) -> RaceCurve:
    """Read the scores that :func:`~sarah.reports.race.run_entry` wrote.

    :param entry: training that is complete
    :raises RunFolderError: if they cannot be read
    """
    *along, last = _rows(entry)
    final, count = _scores(entry)[: entry.evaluations.final], entry.evaluations.along
    try:
        return RaceCurve(
            entry.config.algo,
            tuple(whole_number(row["episodes"]) for row in [*along, last]),
            (*(number(row["score"]) for row in along), mean(final[:count])),
            final,
            count,
            number(last["seconds"]),
        )
    except (KeyError, TypeError, ValueError) as error:
        raise unreadable(entry.folder / RACE_FILE, error) from error


def _scores(entry: Entry) -> tuple[float, ...]:
    """Scores of a final recommendation in the judging episodes, in the order of their seeds; none without the file."""
    path = entry.folder / SCORES_FILE
    if not path.exists():
        return ()
    try:
        rows = list(csv.DictReader(read_lines(path, MOST_EVALUATIONS + 1)))
        if [row["seed"] for row in rows] != [str(seed) for seed in range(len(rows))]:
            raise ValueError("its seeds are not 0, 1, 2 and so on")
        return tuple(number(row["score"]) for row in rows)
    except (OSError, csv.Error, KeyError, TypeError, ValueError) as error:
        raise unreadable(path, error) from error


def _rows(entry: Entry) -> list[dict[str, str]]:
    """Rows of the race's table in a run folder: at most one for each episode, and one for the end."""
    path = entry.folder / RACE_FILE
    try:
        rows = list(csv.DictReader(read_lines(path, entry.config.episodes + 2)))
    except (OSError, csv.Error) as error:
        raise unreadable(path, error) from error
    if not rows:
        raise unreadable(path, ValueError("it has no rows"))
    return rows
