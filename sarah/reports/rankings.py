"""The table of a race: after how many episodes each algorithm gets where, and how far.

A race knows recommendations after every five episodes only. So all counts of episodes are ones at which there was a
recommendation, also the median of an even number of trainings, which is the higher one of the two in the middle.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median, median_high

import numpy as np

from sarah.reports.race import RaceCurve

HELD = 3
"""Number of consecutive evaluations that must reach a share of the best known score."""
SHARES = (0.9, 0.95)
"""Shares of the best known score; the table counts the episodes until each is reached."""
CONFIDENCE = 0.95
BOOTSTRAP_DRAWS = 2000

ORIGINS = {
    "naf": "chosen on the tasks stepping and balance, its warm-up too, which all algorithms with a model share",
    "td3": "set once by hand, and not tuned",
    "sac": "set once by hand, and not tuned",
    "ddpg": "set once by hand, and not tuned",
    "cma-es": "the population is that of the package cma, the deviation set once by hand, and not tuned",
    "gp": "the defaults of Optuna",
    "tpe": "the defaults of Optuna",
    "random": "it has none",
}
"""Origin of each algorithm's settings: one that was tuned on the raced task has an advantage over the others."""
UNKNOWN_ORIGIN = "nobody has said where they come from"


@dataclass(frozen=True)
class Ranking:
    """The results of one algorithm in a race.

    :param algo: name of the algorithm
    :param runs: number of trainings, one for each seed
    :param reached: number of trainings that reached a share of the best known score, by share
    :param episodes: median number of episodes until a share is reached, by share, after which more than half of the
        trainings have reached it; infinite if they never have
    :param final: interquartile mean of the final scores, and the ends of its 95 % bootstrap interval
    :param seconds: median wall time of a training, in s
    """

    algo: str
    runs: int
    reached: dict[float, int]
    episodes: dict[float, float]
    final: tuple[float, float, float]
    seconds: float


def episodes_until(curve: RaceCurve, score: float) -> float:
    """Number of episodes until a score is reached and held over :data:`HELD` evaluations; infinite if it never is.

    :param curve: scores of a training; of two after the same number of episodes, the later one counts
    :param score: score to reach
    """
    evaluated = dict(zip(curve.episodes, curve.scores, strict=True))
    reached = [value >= score for value in evaluated.values()]
    for index, episodes in enumerate(evaluated):
        held = reached[index : index + HELD]
        if len(held) == HELD and all(held):
            return float(episodes)
    return math.inf


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
        until = {share: [episodes_until(curve, best - (1.0 - share) * abs(best)) for curve in runs] for share in SHARES}
        table.append(
            Ranking(
                algo,
                len(runs),
                {share: sum(np.isfinite(counts).tolist()) for share, counts in until.items()},
                {share: median_high(counts) for share, counts in until.items()},
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
    """Markdown table of the rankings, and under it where each algorithm's settings come from.

    :param table: rankings from :func:`rankings`
    """
    shares = "".join(f" {share:.0%} of the best after | reached by |" for share in SHARES)
    lines = [f"| algorithm | runs |{shares} final score | wall time |", "|---" * (4 + 2 * len(SHARES)) + "|"]
    for row in table:
        cells = "".join(f" {_count(row.episodes[share])} | {row.reached[share]} |" for share in SHARES)
        score, low, high = row.final
        lines.append(
            f"| {row.algo} | {row.runs} |{cells} {score:.3f} ({low:.3f} to {high:.3f}) | {row.seconds:.0f} s |"
        )
    named: dict[str, list[str]] = {}
    for row in table:
        named.setdefault(ORIGINS.get(row.algo, UNKNOWN_ORIGIN), []).append(row.algo)
    settings = (f"- {', '.join(names)}: {origin}" for origin, names in named.items())
    return "\n".join([*lines, "", "Settings:", "", *settings])


def _count(episodes: float) -> str:
    return f"{episodes:.0f}" if math.isfinite(episodes) else "not reached"


def write_csv(table: Sequence[Ranking], path: Path) -> None:
    """Write the rankings as CSV. Counts of episodes that were never reached are ``inf``.

    :param table: rankings from :func:`rankings`
    :param path: path of the file
    """
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        counted = [f"{name}_{share:.0%}" for share in SHARES for name in ("episodes", "reached")]
        writer.writerow(("algorithm", "runs", *counted, "final_score", "final_low", "final_high", "seconds"))
        for row in table:
            counts = [value for share in SHARES for value in (f"{row.episodes[share]:.0f}", row.reached[share])]
            writer.writerow((row.algo, row.runs, *counts, *row.final, row.seconds))
