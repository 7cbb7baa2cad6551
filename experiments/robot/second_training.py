"""Does the robot learn to come back after a push, and how close do trainings come to the best known V1 to V4?

All sets meet the same pushes. They are judged in the engine in which they were learned.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from pandas import DataFrame, Series

from experiments.record import Row
from experiments.robot import best_known
from experiments.robot.balance_trainings import JUDGING_SEED, NAMES, PUSH_100
from experiments.robot.best_known import BEST, KNOWN, NEUTRAL, SearchExperiment
from experiments.robot.conditions import SETTINGS
from experiments.shapes import groups, legend, panels, strips
from experiments.tables import WORDS, shown, survived_pushes, table
from sarah.control.parameters import Parameters
from sarah.reports.uncertainty import number_at, standard_error
from sarah.simulation.engines import Engine

RECOMMENDED, MU, COMPARED = "recommended", "mu", "compared with"
"""What a set of V1 to V4 is: a training's recommendation, what its network says, or one to compare these with."""
ENOUGH = 0.95
"""Share of the best known score from which a training counts as close to it."""


@dataclass(frozen=True)
class SecondTraining(SearchExperiment):
    """Second Trainings by NAF: what each recommends, and how this and the network's own V1 to V4 do."""

    judging: int = 300  # number of pushes that judge a set
    surviving: int = 100  # number of pushes of 100 N by which survival is judged

    def cases(self) -> list[Row]:
        """The known sets, then those of each training; engines in turn."""
        runs = [(COMPARED, run) for run in KNOWN]
        runs += [(kind, f"naf seed {seed}") for seed in self.training_seeds for kind in (RECOMMENDED, MU)]
        return [{"kind": kind, "run": run, "engine": engine} for kind, run in runs for engine in self.engines]

    def rows(self, kind: str, run: str, engine: Engine) -> Iterator[Row]:
        """How a set does. Scores stand in one cell, for their number."""
        parameters = self._parameters(kind, run, engine)
        survivable = self.condition("100 N", engine, JUDGING_SEED + 2000, self.surviving, PUSH_100)
        scores = self.judge.scores(parameters, self.pushes(engine, JUDGING_SEED, self.judging))
        yield {
            **dict(zip(NAMES, parameters, strict=True)),
            "survival_100": float(np.mean(self.judge.outcomes(parameters, survivable)["survived"])),
            "scores": " ".join(f"{score:.4f}" for score in scores),
        }

    def _parameters(self, kind: str, run: str, engine: Engine) -> Parameters:
        """V1 to V4 of a set. The search is made in this process if the result ``best_known`` lacks it."""
        if kind != COMPARED:
            return self.trainings(engine)[run][kind == MU]
        rows = [row for row in self.rows_of("best_known", engine) if row["run"] == run]
        return tuple(float(rows[0][name]) for name in NAMES) if rows else self.found(engine)[run]


FULL = SecondTraining()
QUICK = SecondTraining(**vars(best_known.QUICK) | {"workers": 0}, judging=3, surviving=1)  # all cases share a training


def ratio(name: str, values: np.ndarray, others: np.ndarray) -> Row:
    """Columns of the ratio of two means and of its standard error, which is small where values go with the others.

    :param values: values of the numerator, of shape (sets, episodes)
    :param others: values of the denominator in the same episodes
    """
    found = float(values.mean() / others.mean())
    return {name: found, f"{name}_error": standard_error(values - found * others) / float(others.mean())}


def _scores(rows: DataFrame) -> np.ndarray:
    """Scores under the pushes that judge, of shape (sets, pushes)."""
    return np.array([[float(score) for score in cell.split()] for cell in rows.scores])


def _engines(rows: DataFrame) -> dict[str, DataFrame]:
    """The rows of each engine in which trainings have been judged; all that they are compared with comes before."""
    return {engine: group for engine, group in groups(rows, "engine").items() if (group.kind == RECOMMENDED).any()}


def _judged(group: DataFrame) -> list[str]:
    """What has been judged of the trainings in an engine, of which the networks' sets may be still to come."""
    return [kind for kind in (RECOMMENDED, MU) if (group.kind == kind).any()]


def _known(rows: DataFrame, run: str) -> DataFrame:
    """The row of a set that trainings are compared with, of an engine's rows."""
    return rows[(rows.kind == COMPARED) & (rows.run == run)]


def _of_best(rows: DataFrame, best: DataFrame) -> Series:
    """Share of the best known score that each set reaches."""
    return Series(_scores(rows).mean(axis=1) / _scores(best).mean(), rows.index)


def _summary(group: DataFrame, kind: str) -> Row:
    """Columns of what the trainings of an engine reach together.

    :param group: rows of the engine
    :param kind: whether it is what they recommend, or what their networks say
    """
    rows, best = group[group.kind == kind], _known(group, BEST)
    scores, of_best = _scores(rows), _of_best(rows, best)
    close = number_at(scores, np.full(len(rows), True), ENOUGH, _scores(best)[0])
    return {
        "trainings": len(rows),
        **ratio("of_best", scores, _scores(best)),
        "lowest": of_best.min(),
        **dict(zip(("within_5_%", "within_5_%_low", "within_5_%_high"), close, strict=True)),
        "survival_100": rows.survival_100.mean(),
        "lowest_survival": rows.survival_100.min(),
    }


def answer(rows: DataFrame) -> str:
    """Whether the robot learns to come back."""
    sentences = []
    for engine, group in _engines(rows).items():
        (neutral,) = _known(group, NEUTRAL).survival_100
        survived = survived_pushes(group[group.kind == RECOMMENDED].survival_100, 100.0)
        sentences.append(
            f"In {WORDS[engine]} the robot survives {survived} after each training. With locked hips it"
            f" survives {shown(neutral, '.0%')} of them."
        )
    return " ".join(sentences)


def under_hard_pushes(rows: DataFrame) -> str:
    """How near trainings come to the best known score."""
    sentences = []
    for engine, group in _engines(rows).items():
        found = _summary(group, RECOMMENDED)
        sentences.append(
            f"In {WORDS[engine]} the {found['trainings']} trainings reach {shown(found['of_best'], '.1%')} of the best"
            f" known score under harder pushes on average. {found['within_5_%']} of them come within"
            " 5\N{NO-BREAK SPACE}% of it."
        )
    return " ".join(sentences)


def headroom(rows: DataFrame) -> str:
    """How much better than the shipped V1 to V4 could be."""
    reached = [
        f"{shown(_of_best(_known(group, 'shipped'), _known(group, BEST)).iloc[0], '.1%')} of the best known score in"
        f" {WORDS[engine]}"
        for engine, group in _engines(rows).items()
    ]
    return f"The shipped V1 to V4 reach {' and '.join(reached)}."


def figure(rows: DataFrame) -> Figure:
    """Where V1 to V4 settle, and how close trainings come to the best known score."""
    engines = _engines(rows)
    drawn, (*settled, shares) = panels(len(engines) + 1, 0.35)
    columns = {}
    for axis, (engine, group) in zip(settled, engines.items(), strict=True):
        best, learned = _known(group, BEST), group[group.kind == RECOMMENDED]
        marks = {name: float(best[name].iloc[0]) for name in NAMES}
        strips(axis, {name: learned[name] for name in NAMES}, marks, BEST)
        axis.set_title(WORDS[engine], fontsize="small")
        for kind in _judged(group):
            word = "learned" if kind == RECOMMENDED else kind  # columns are narrow
            columns[f"{WORDS[engine]}\n{word}"] = _of_best(group[group.kind == kind], best)
    strips(shares, columns, dict.fromkeys(columns, 1.0))
    shares.set_ylabel("score over the best known one")
    shares.tick_params(axis="x", labelsize="x-small")
    legend(drawn, settled[0])
    return drawn


def closeness(rows: DataFrame) -> str:
    """How close trainings come to the best known set, for what they recommend and for what their networks say."""
    found = [
        {"engine": engine, "set": kind, **_summary(group, kind)}
        for engine, group in _engines(rows).items()
        for kind in _judged(group)
    ]
    caption = (
        "Score as a share of the best known one in the engine: mean with its standard error, and lowest. Number of"
        " trainings within 5 % of the best known score, with its 95 % interval. Survival of"
        f" {FULL.surviving} pushes of 100 N from all directions: mean and lowest. {SETTINGS}"
    )
    formats = dict.fromkeys(("of_best", "survival_100", "lowest", "lowest_survival"), ".1%")
    return table(DataFrame(found), list(found[0]), caption, **formats)


def compared(rows: DataFrame) -> str:
    """The sets that trainings are compared with."""
    found: list[dict[str, Any]] = []
    for engine, group in _engines(rows).items():
        best = _scores(_known(group, BEST))
        for run in KNOWN:
            scores = _scores(_known(group, run))
            found.append({"engine": engine, "run": run, "score": scores.mean(), **ratio("of_best", scores, best)})
    caption = (
        f"The sets that trainings are compared with: mean score under {FULL.judging} hard pushes, also as a share of"
        " the best known score, with its standard error."
    )
    return table(DataFrame(found), list(found[0]), caption, of_best=".1%")
