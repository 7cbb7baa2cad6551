"""Does the robot learn to come back after a push, and how close do trainings come to the best known V1 to V4?

The best known set of an engine is found by a search around the shipped set and around what trainings recommend, on
pushes of other seeds than those that judge it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure
from pandas import DataFrame, Series

from experiments.record import Row
from experiments.robot.balance_trainings import (
    CHOOSING_SEED,
    JUDGING_SEED,
    NAMES,
    PUSH_100,
    SHIPPED,
    SecondTrainingExperiment,
)
from experiments.shapes import groups, legend, panels, strips
from experiments.tables import WORDS, shown, table
from sarah.control.parameters import BALANCE_PARAMETERS, Parameters
from sarah.episode.tasks import BALANCE
from sarah.reports.uncertainty import standard_error
from sarah.simulation.engines import Engine

NEUTRAL, BEST, MEAN = "V = 0", "best known", "mean of trainings"
KNOWN = (NEUTRAL, "shipped", "best training", "search winner", BEST)
"""Sets that the trainings are compared with."""
ROUNDS = ((1, 9), (4, 24), (16, 87), (32, 300))
"""Divisor of the number of candidates that each round of the search leaves, and number of pushes met by its end."""
DEVIATION = (0.3, 0.8, 0.3, 0.8)
"""Standard deviation of candidates around a known set; what V2 and V4 do shows over longer distances."""
ENOUGH = 0.95
"""Share of the best known score from which a training counts as close to it."""


@dataclass(frozen=True)
class SecondTraining(SecondTrainingExperiment):
    """Second Trainings by NAF: what each recommends, and how this and the network's own V1 to V4 do."""

    judging: int = 300  # number of pushes that judge a set, and of those that choose the best one
    candidates: int = 256  # number of sets that the search for the best known set begins with
    surviving: int = 100  # number of pushes of 100 N by which survival is judged

    def cases(self) -> list[Row]:
        """The known sets, each training, and the mean of all trainings; engines in turn, which share no search."""
        runs = [*KNOWN, *(f"naf seed {seed}" for seed in self.training_seeds), MEAN]
        return [{"engine": engine, "run": run} for run in runs for engine in self.engines]

    def rows(self, engine: Engine, run: str) -> Iterator[Row]:
        """How a set does, or all trainings together."""
        trainings = self.trainings(engine)
        known = self._known(engine, trainings)
        best = self._scores(engine, [known[BEST]])
        asked = [training for name, training in trainings.items() if run in (name, MEAN)]
        recommended = [one for one, _ in asked] or [known[run]]
        yield {
            **dict(zip(NAMES, [None] * len(NAMES) if run == MEAN else recommended[0], strict=True)),
            "score": float(self._scores(engine, recommended).mean()),
            **self._judged("", engine, recommended, best),
            **self._judged("mu_", engine, [mu for _, mu in asked], best),
        }

    def _judged(self, prefix: str, engine: Engine, sets: Sequence[Parameters], best: np.ndarray) -> Row:
        """Columns of what the judge says about sets."""
        of_best, survival = f"{prefix}of_best", f"{prefix}survival_100"
        if not sets:
            return dict.fromkeys((of_best, f"{of_best}_error", survival))
        survivable = self.condition("100 N", engine, JUDGING_SEED + 2000, self.surviving, PUSH_100)
        survived = [self.judge.outcomes(one, survivable)["survived"] for one in sets]
        return {**ratio(of_best, self._scores(engine, sets), best), survival: float(np.mean(survived))}

    def _scores(self, engine: Engine, sets: Sequence[Parameters]) -> np.ndarray:
        """Scores under the pushes that judge, of shape (sets, pushes)."""
        asked = self.pushes(engine, JUDGING_SEED, self.judging)
        return np.array([self.judge.scores(one, asked) for one in sets])

    def _known(self, engine: Engine, trainings: Mapping[str, tuple[Parameters, Parameters]]) -> dict[str, Parameters]:
        """The sets that trainings are compared with, by name. Outcomes of the search are kept, so it is made once."""
        assert BALANCE.neutral is not None
        recommended = [one for one, _ in trainings.values()]
        known = list(dict.fromkeys([SHIPPED, *recommended, *(mu for _, mu in trainings.values())]))
        drawn = around([SHIPPED, *recommended], max(1, self.candidates - len(known)))

        def scores(sets: Sequence[Parameters], episodes: int) -> list[float]:
            asked = self.pushes(engine, CHOOSING_SEED, min(episodes, self.judging))
            return [float(self.judge.scores(one, asked).mean()) for one in sets]

        candidates = list(dict.fromkeys([*known, *drawn]))
        rounds = [(max(1, len(candidates) // divisor), episodes) for divisor, episodes in ROUNDS]
        ranked = successive_halving(candidates, rounds, scores)
        first_of = [next(one for one in ranked if one in group) for group in (recommended, drawn, ranked)]
        return dict(zip(KNOWN, [BALANCE.neutral, SHIPPED, *first_of], strict=True))


FULL = SecondTraining()
QUICK = SecondTraining(time_limit=2.0, budget=5, engines=("mujoco",), seeds=1, judging=3, candidates=4, surviving=1)


def successive_halving(
    candidates: Sequence[Parameters],
    rounds: Sequence[tuple[int, int]],
    scores: Callable[[Sequence[Parameters], int], Sequence[float]],
) -> list[Parameters]:
    """Candidates, the best first.

    :param rounds: number of the best that take part in each round, and number of episodes that they have met by its end
    :param scores: function that returns the scores of some sets after so many episodes
    """
    ranked = list(candidates)
    for count, episodes in rounds:
        part = ranked[:count]
        found = dict(zip(part, scores(part, episodes), strict=True))
        ranked[:count] = sorted(part, key=found.__getitem__, reverse=True)
    return ranked


def around(centres: Sequence[Parameters], count: int) -> list[Parameters]:
    """Sets drawn around known ones, within the box."""
    generator = np.random.default_rng(0)
    low, high = ([getattr(parameter, end) for parameter in BALANCE_PARAMETERS] for end in ("low", "high"))
    drawn = []
    for _ in range(count):
        centre = centres[int(generator.integers(len(centres)))]
        drawn.append(tuple(map(float, generator.normal(centre, DEVIATION).clip(low, high))))
    return drawn


def ratio(name: str, values: np.ndarray, others: np.ndarray) -> Row:
    """Columns of the ratio of two means and of its standard error, which is small where values go with the others.

    :param values: values of the numerator, of shape (sets, episodes)
    :param others: values of the denominator in the same episodes
    """
    found = float(values.mean() / others.mean())
    return {name: found, f"{name}_error": standard_error(values - found * others) / float(others.mean())}


def _learned(rows: DataFrame) -> DataFrame:
    """Rows of the trainings."""
    return rows[rows.run.str.startswith("naf")]


def _of_run(rows: DataFrame, run: str) -> Series:
    """The row of a run."""
    return rows[rows.run == run].iloc[0]


def answer(rows: DataFrame) -> str:
    """Whether the robot learns to come back."""
    sentences = []
    for engine, group in groups(rows, "engine").items():
        mean, neutral, runs = _of_run(group, MEAN), _of_run(group, NEUTRAL), _learned(group)
        survival = [shown(share, ".0%") for share in (mean.survival_100, runs.survival_100.min(), neutral.survival_100)]
        sentences.append(
            f"In {WORDS[engine]} the robot survives {survival[0]} of pushes of 100 N after a training,"
            f" {survival[1]} after the worst one, and {survival[2]} without the hip law. Under harder pushes the"
            f" {len(runs)} trainings reach {shown(mean.of_best, '.1%')} of the best known score on average, and"
            f" {(runs.of_best >= ENOUGH).sum()} of them come within 5 % of it."
        )
    return " ".join(sentences)


def headroom(rows: DataFrame) -> str:
    """How much better than the shipped V1 to V4 could be."""
    reached = [
        f"{shown(_of_run(group, 'shipped').of_best, '.1%')} of the best known score in {WORDS[engine]}"
        for engine, group in groups(rows, "engine").items()
    ]
    return f"The shipped V1 to V4 reach {' and '.join(reached)}."


def figure(rows: DataFrame) -> Figure:
    """Where V1 to V4 settle, and how close trainings come to the best known score."""
    engines = groups(rows, "engine")
    drawn, (*settled, shares) = panels(len(engines) + 1, 0.35)
    columns = {}
    for axis, (engine, group) in zip(settled, engines.items(), strict=True):
        best = _of_run(group, BEST)
        strips(axis, {name: _learned(group)[name] for name in NAMES}, {name: best[name] for name in NAMES}, BEST)
        axis.set_title(WORDS[engine], fontsize="small")
        columns[f"{WORDS[engine]}\nlearned"] = _learned(group).of_best
        columns[f"{WORDS[engine]}\nmu"] = _learned(group).mu_of_best
    strips(shares, columns, dict.fromkeys(columns, 1.0))
    shares.set_ylabel("score over the best known one")
    shares.tick_params(axis="x", labelsize="x-small")
    legend(drawn, settled[0])
    return drawn


def closeness(rows: DataFrame) -> str:
    """How close trainings come to the best known set, for what they recommend and for what their networks say."""
    found = []
    for engine, group in groups(rows, "engine").items():
        for kind, prefix in (("recommended", ""), ("mu", "mu_")):
            shares, mean = _learned(group)[f"{prefix}of_best"], _of_run(group, MEAN)
            columns = {column: mean[f"{prefix}{column}"] for column in ("of_best", "of_best_error", "survival_100")}
            close = {"within_5_%": (shares >= ENOUGH).sum(), "lowest": shares.min()}
            found.append({"engine": engine, "set": kind, **columns, **close})
    caption = (
        f"Score over that of the best known set of the engine: mean of {FULL.seeds} trainings, with its standard error"
        " over trainings and pushes; mean survival of pushes of 100 N; number of trainings within 5 % of the best known"
        " score; lowest share of a training."
    )
    formats = dict.fromkeys(("of_best", "survival_100", "lowest"), ".1%")
    return table(DataFrame(found), list(found[0]), caption, **formats)


def compared(rows: DataFrame) -> str:
    """The sets that trainings are compared with."""
    columns = ["engine", "run", *NAMES, "score", "of_best", "of_best_error"]
    caption = (
        f"The sets that trainings are compared with: mean score under {FULL.judging} hard pushes, and its share of the"
        " best known score with its standard error. P1 to P5 are the shipped ones."
    )
    known = rows[rows.run.isin(KNOWN)].sort_values("engine", kind="stable")
    return table(known, columns, caption, of_best=".1%")
