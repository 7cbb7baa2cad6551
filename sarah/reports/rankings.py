"""The table of a race: how good each algorithm's final recommendations are, and after how many episodes it gets where.

Final recommendations are judged by many episodes, those along the way by the first of them. Each is compared with the
best known score in the episodes that judge it.

A race knows recommendations after every five episodes only, so all counts of episodes are ones with a recommendation.
For an even number of trainings the median is the higher one of the two in the middle.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median, median_high

import numpy as np

from sarah.reports.judging import Evaluations
from sarah.reports.race_entry import RaceCurve
from sarah.reports.uncertainty import best_known, difference, number_at, share_of, standard_error

HELD = 3
"""Number of consecutive evaluations that must reach a share of the best known score."""
SHARES = (0.9, 0.95)
"""Shares of the best known score; the table counts the episodes until each is reached and held."""
FINAL_SHARE = 0.95
"""Share of the best known score that the table counts final recommendations at."""

ORIGINS = {
    "naf": "chosen on the tasks stepping and balance, its warm-up too",
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
    :param score: mean final score, and its standard error over trainings and judging episodes
    :param over_reference: mean difference to the reference, and both ends of its 95 % interval; none without another
        algorithm to compare with
    :param at_share: number of trainings whose final score is at least :data:`FINAL_SHARE` of the best known one, and
        both ends of its 95 % interval over the judging episodes
    :param episodes: median number of episodes along the way until a share is reached and held, by share, after which
        more than half of the trainings have reached it; infinite if they never have
    :param held: number of trainings that reached and held a share along the way, by share
    :param seconds: median wall time of a training, in s
    """

    algo: str
    runs: int
    score: tuple[float, float]
    over_reference: tuple[float, float, float] | None
    at_share: tuple[int, int, int]
    episodes: dict[float, float]
    held: dict[float, int]
    seconds: float


@dataclass(frozen=True)
class Rankings:
    """The table of a race.

    :param rows: row of each algorithm; the one that reaches the highest share soonest comes first
    :param reference: name of the algorithm that the others are compared with
    :param evaluations: numbers of judging episodes
    :param best: best known score, in all judging episodes
    :param best_along: best known score in the episodes along the way
    """

    rows: tuple[Ranking, ...]
    reference: str
    evaluations: Evaluations
    best: float
    best_along: float

    def columns(self, row: Ranking) -> dict[str, str | float | None]:
        """Values of a row by column, as files have them: none where nothing is known.

        :param row: one of :attr:`rows`
        """
        over = row.over_reference or (math.nan,) * 3
        values: dict[str, str | float] = {"algorithm": row.algo, "runs": row.runs}
        values |= zip(("final_score", "final_score_error"), row.score, strict=True)
        values |= zip(_with_ends(f"over_{self.reference}"), over, strict=True)
        values |= zip(_with_ends(f"final_at_{100 * FINAL_SHARE:.0f}"), row.at_share, strict=True)
        for share in SHARES:
            values[f"episodes_to_{100 * share:.0f}"] = row.episodes[share]
            values[f"held_{100 * share:.0f}"] = row.held[share]
        values["wall_time_s"] = round(row.seconds)
        return {name: None if value != value else value for name, value in values.items()}


def _with_ends(name: str) -> tuple[str, str, str]:
    """Columns of a value and of both ends of its interval."""
    return name, f"{name}_low", f"{name}_high"


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


def _over(scores: np.ndarray, others: np.ndarray) -> tuple[float, float, float]:
    """Difference from the reference; a single judging episode says nothing of others, so it gives no interval."""
    found, *ends = difference(scores, others)
    low, high = ends if scores.shape[1] > 1 else (math.nan, math.nan)
    return found, low, high


def rankings(curves: Sequence[RaceCurve], best: float | None = None, reference: str | None = None) -> Rankings:
    """Summarise a race by algorithm.

    :param curves: scores of all trainings, those of each algorithm in the same order of seeds
    :param best: best known score, whose shares are to be reached; by default that of the race, see
        :func:`~sarah.reports.uncertainty.best_known`
    :param reference: name of the algorithm that the others are compared with; by default the first one
    """
    names, reference = np.array([curve.algo for curve in curves]), reference or curves[0].algo
    scores, along = np.array([curve.final for curve in curves]), curves[0].along
    best_along = best_known(scores, along) if best is None else best
    rows = []
    for algo in dict.fromkeys(names.tolist()):
        own, compared = names == algo, algo != reference and reference in names
        runs = [curve for curve in curves if curve.algo == algo]
        until = {share: [episodes_until(curve, share_of(best_along, share)) for curve in runs] for share in SHARES}
        rows.append(
            Ranking(
                algo,
                len(runs),
                (float(scores[own].mean()), standard_error(scores[own])),
                _over(scores[own], scores[names == reference]) if compared else None,
                number_at(scores, own, FINAL_SHARE, best),
                {share: median_high(counts) for share, counts in until.items()},
                {share: sum(np.isfinite(counts).tolist()) for share, counts in until.items()},
                median(curve.seconds for curve in runs),
            )
        )
    return Rankings(
        tuple(sorted(rows, key=lambda row: (row.episodes[SHARES[-1]], -row.score[0]))),
        reference,
        Evaluations(scores.shape[1], along),
        best_known(scores) if best is None else best,
        best_along,
    )


def as_markdown(table: Rankings) -> str:
    """Markdown table of the rankings, and under it how to read it, and where each algorithm's settings come from.

    :param table: rankings from :func:`rankings`
    """
    columns = ["algorithm", "runs", "final score", f"over {table.reference}", f"final score at {_percent(FINAL_SHARE)}"]
    for share in SHARES:
        columns += [f"{_percent(share)} held after", "by"]
    rows = [_cells(row) for row in table.rows]
    lines = [f"| {' | '.join(cells)} |" for cells in ([*columns, "wall time"], *rows)]
    lines.insert(1, "|---" * (len(columns) + 1) + "|")
    named: dict[str, list[str]] = {}
    for row in table.rows:
        named.setdefault(ORIGINS.get(row.algo, UNKNOWN_ORIGIN), []).append(row.algo)
    settings = (f"- {', '.join(names)}: {origin}" for origin, names in named.items())
    return "\n".join([*lines, "", *_legend(table), "", "Settings:", "", *settings])


def _cells(row: Ranking) -> list[str]:
    (score, error), (number, fewest, most) = row.score, row.at_share
    over = "" if row.over_reference is None else f"{row.over_reference[0]:+.3f}"
    if row.over_reference and math.isfinite(row.over_reference[1]):
        over += " ({:+.3f} to {:+.3f})".format(*row.over_reference[1:])
    cells = [row.algo, str(row.runs), f"{score:.3f}" + (f" ± {error:.3f}" if math.isfinite(error) else "")]
    cells += [over, f"{number} ({fewest} to {most})"]
    for share in SHARES:
        cells += [_count(row.episodes[share]), str(row.held[share])]
    return [*cells, f"{row.seconds:.0f} s"]


def _percent(share: float) -> str:
    return f"{100 * share:.0f} %"


def _legend(table: Rankings) -> list[str]:
    """Lines that say how to read the table."""
    final, along = table.evaluations.final, table.evaluations.along
    return [
        f"{final} unseen episodes judge every final recommendation, and the first {along} of them those along the way.",
        f"The best known score is {table.best:.3f}, and {table.best_along:.3f} in the first {along}.",
        "",
        "- final score: mean over trainings and judging episodes ± its standard error",
        f"- over {table.reference}: mean difference of final scores (95 % interval over seeds and judging episodes)",
        f"- final score at {_percent(FINAL_SHARE)}: trainings that end with this share of the best known score or more",
        "  (95 % interval over the judging episodes)",
        f"- held: reached along the way in {HELD} evaluations in a row, by the median training, and by how many",
    ]


def _count(episodes: float) -> str:
    return f"{episodes:.0f}" if math.isfinite(episodes) else "not reached"


def write_csv(table: Rankings, path: Path) -> None:
    """Write the rankings as CSV. Counts of episodes that were never reached are ``inf``.

    :param table: rankings from :func:`rankings`
    :param path: path of the file
    """
    rows = [table.columns(row) for row in table.rows]
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
