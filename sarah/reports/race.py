"""A race: several algorithms with several seeds each, compared by their recommendations.

Each training has a run folder. Its recommendations after every five episodes are evaluated on seeds that no training
sees, and the scores are written to ``race.csv`` in the run folder. A training with a ``race.csv`` is not run again; if
the number of unseen seeds has changed, it is only evaluated again.
"""

from __future__ import annotations

import csv
import dataclasses
import io
import os
import shutil
import time
from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

from sarah.episode.evaluation import evaluate
from sarah.episode.tasks import TASKS
from sarah.episode.workers import Workers
from sarah.errors import RunFolderError
from sarah.files import replace_text
from sarah.runs.agent_settings import settings_of
from sarah.runs.config import TrainingConfig
from sarah.runs.journal import Journal
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train

RACE_FILE = "race.csv"
"""Name of the file in every run folder of a race: scores of its recommendations, during the training and at its end."""
HELD = 3
"""Number of consecutive evaluations that must reach a share of the best known score."""
SHARES = (0.9, 0.95)
"""Shares of the best known score; the table counts the episodes until each is reached."""
CONFIDENCE = 0.95
BOOTSTRAP_DRAWS = 2000


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
    :param seconds: wall time of the training, without the evaluations, in s
    """

    algo: str
    episodes: tuple[int, ...]
    scores: tuple[float, ...]
    seconds: float


@dataclass(frozen=True)
class Ranking:
    """The results of one algorithm in a race.

    :param algo: name of the algorithm
    :param runs: number of trainings, one for each seed
    :param reached: number of trainings that reached a share of the best known score, by share
    :param episodes: median number of episodes until a share is reached, by share; trainings that did not reach it count
        as infinite
    :param final: interquartile mean of the final scores, and the ends of its 95 % bootstrap interval
    :param seconds: median wall time of a training, in s
    """

    algo: str
    runs: int
    reached: dict[float, int]
    episodes: dict[float, float]
    final: tuple[float, float, float]
    seconds: float


def race(entries: Sequence[Entry], workers: Workers) -> list[RaceCurve]:
    """Run the trainings that are not complete, each in one process, and read the scores of all.

    :param entries: trainings of the race; on a cluster, all workers must share the file system of their folders
    :param workers: workers that train
    :raises RunFolderError: if a folder is not a run folder of a race, or has a training with other settings
    """
    for entry in entries:
        if entry.folder.exists() and not is_run(entry):
            raise RunFolderError(f"{entry.folder} is not of a race: name another folder")
        if is_run(entry) and RunFolder(entry.folder).config() != entry.config:
            raise RunFolderError(f"{entry.folder} is a training with other settings: name another folder")
    jobs = [workers.submit(run_entry, entry) for entry in entries if not is_evaluated(entry)]
    for job in jobs:
        job.result()
    return [read_curve(entry) for entry in entries]


def is_run(entry: Entry) -> bool:
    """Whether a training and an evaluation of it are complete.

    :param entry: training of the race
    """
    return (entry.folder / RACE_FILE).is_file()


def is_evaluated(entry: Entry) -> bool:
    """Whether a training is complete, and evaluated on as many unseen seeds as the race asks for.

    :param entry: training of the race
    """
    return is_run(entry) and _rows(entry.folder)[0].get("evaluations") == str(entry.evaluations)


def run_entry(entry: Entry) -> None:
    """Train, and evaluate every recommendation, in a folder that gets its name when it is complete.

    A complete training is only evaluated.

    :param entry: training of the race
    :raises RunFolderError: if another race runs this training
    """
    if is_run(entry):
        _evaluate_recommendations(entry, entry.folder, read_curve(entry).seconds)
        return
    unfinished = entry.folder.with_name(f"{entry.folder.name}.unfinished")
    if unfinished.exists():  # an interrupted race left it, or another race is using it
        journal = RunFolder(unfinished).journal_path
        with Journal(journal, entry.config, Workers()) if journal.exists() else nullcontext():
            shutil.rmtree(unfinished)
    start = time.perf_counter()
    run = RunFolder.create(unfinished, entry.config)
    train(entry.config, run)
    _evaluate_recommendations(entry, unfinished, time.perf_counter() - start)
    os.replace(unfinished, entry.folder)


def _evaluate_recommendations(entry: Entry, folder: Path, seconds: float) -> None:
    """Write the scores of all recommendations, during the training and at its end."""
    run = RunFolder(folder)
    names = TASKS[entry.config.task].parameter_names
    along = [(int(row["episodes"]), tuple(float(row[name]) for name in names)) for row in run.recommendations()]
    known: dict[tuple[float, ...], float] = {}
    config = entry.config
    text = io.StringIO(newline="")
    writer = csv.writer(text)
    writer.writerow(("episodes", "score", "seconds", "evaluations"))
    for episodes, parameters in [*along, (config.episodes, run.parameters())]:
        if parameters not in known:
            evaluation = evaluate(config.task, parameters, config.episode, range(entry.evaluations))
            known[parameters] = evaluation.mean("score")
        writer.writerow((episodes, known[parameters], seconds, entry.evaluations))
    replace_text(folder / RACE_FILE, text.getvalue())


def read_curve(entry: Entry) -> RaceCurve:
    """Read the scores that :func:`run_entry` wrote.

    :param entry: training that is complete
    """
    rows = _rows(entry.folder)
    return RaceCurve(
        entry.config.algo,
        tuple(int(row["episodes"]) for row in rows),
        tuple(float(row["score"]) for row in rows),
        float(rows[0]["seconds"]),
    )


def _rows(folder: Path) -> list[dict[str, str]]:
    with (folder / RACE_FILE).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def episodes_until(curve: RaceCurve, score: float) -> float:
    """Number of episodes until a score is reached and held over :data:`HELD` evaluations; infinite if it never is.

    :param curve: scores of a training
    :param score: score to reach
    """
    reached = [value >= score for value in curve.scores]
    for index in range(len(reached) - HELD + 1):
        if all(reached[index : index + HELD]):
            return float(curve.episodes[index])
    return float("inf")


def rankings(curves: Sequence[RaceCurve], best_known: float | None = None) -> list[Ranking]:
    """Summarise a race by algorithm.

    :param curves: scores of all trainings
    :param best_known: score whose shares are to be reached; by default the best final score of the race
    :return: one ranking for each algorithm; the one that reaches the highest share soonest comes first
    """
    best = max(curve.scores[-1] for curve in curves) if best_known is None else best_known
    table = []
    for algo in dict.fromkeys(curve.algo for curve in curves):
        runs = [curve for curve in curves if curve.algo == algo]
        until = {share: [episodes_until(curve, share * best) for curve in runs] for share in SHARES}
        table.append(
            Ranking(
                algo,
                len(runs),
                {share: sum(np.isfinite(counts).tolist()) for share, counts in until.items()},
                {share: median(counts) for share, counts in until.items()},
                interquartile_mean([curve.scores[-1] for curve in runs]),
                median(curve.seconds for curve in runs),
            )
        )
    return sorted(table, key=lambda row: (row.episodes[SHARES[-1]], -row.final[0]))


def interquartile_mean(values: Sequence[float]) -> tuple[float, float, float]:
    """Mean of the middle half of some values, with its bootstrap interval (Agarwal et al. 2021).

    :param values: values to average, one for each training
    :return: the mean and both ends of its 95 % interval; for a single value, three times that value
    """
    cut = len(values) // 4
    draws = np.random.default_rng(0).choice(np.asarray(values), (BOOTSTRAP_DRAWS, len(values)))
    middle_halves = np.sort(np.vstack([values, draws]), axis=1)[:, cut : len(values) - cut]
    found, *drawn = middle_halves.mean(axis=1)
    low, high = np.quantile(drawn, ((1 - CONFIDENCE) / 2, (1 + CONFIDENCE) / 2))
    return (float(found), float(low), float(high))


def as_markdown(table: Sequence[Ranking]) -> str:
    """Markdown table of the rankings.

    :param table: rankings from :func:`rankings`
    """
    shares = "".join(f" {share:.0%} of the best after | reached by |" for share in SHARES)
    lines = [f"| algorithm | runs |{shares} final score | wall time |", "|---" * (4 + 2 * len(SHARES)) + "|"]
    for row in table:
        cells = "".join(f" {row.episodes[share]:.0f} | {row.reached[share]} |" for share in SHARES)
        score, low, high = row.final
        lines.append(
            f"| {row.algo} | {row.runs} |{cells} {score:.3f} ({low:.3f} to {high:.3f}) | {row.seconds:.0f} s |"
        )
    return "\n".join(lines)


def write_csv(table: Sequence[Ranking], path: Path) -> None:
    """Write the rankings as CSV.

    :param table: rankings from :func:`rankings`
    :param path: path of the file
    """
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        counted = [f"{name}_{share:.0%}" for share in SHARES for name in ("episodes", "reached")]
        writer.writerow(("algorithm", "runs", *counted, "final_score", "final_low", "final_high", "seconds"))
        for row in table:
            counts = [value for share in SHARES for value in (row.episodes[share], row.reached[share])]
            writer.writerow((row.algo, row.runs, *counts, *row.final, row.seconds))


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
