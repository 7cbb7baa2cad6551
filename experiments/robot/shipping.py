"""Which V1 to V4 does the shipping rule choose, and why?

Candidates are what the Second Trainings recommend in both engines, rounded to two digits, and the set that the package
ships. All of them meet the same conditions, in both engines unless it is said otherwise:

- hard pushes, of the kind that judges trainings, but of other seeds;
- hard pushes that are new to all of them, in the last round;
- level ground without a push;
- slopes of 4 and of 6 degrees without a push, uphill in eight directions, of which the worst counts;
- servos of a third of the usual bandwidth, and pushes of 100 N;
- hard pushes of 125 N at PyBullet's reference physics.

A candidate passes if it keeps 95 % of its score on level ground in the worst direction of 4 degrees, and 90 % in that
of 6 degrees, and if it scores no worse under new hard pushes than the shipped set does. It does worse if the difference
of the same pushes is below zero by more than 1.645 standard errors, in either engine. The rounds have chosen by the
other pushes, under which the candidates that are left were lucky. Of those that pass, the rule takes the one with the
highest score relative to that of the shipped set, in the geometric mean over all conditions but the new pushes. Its
order does not depend on which set is shipped. If none passes, the shipped set stays.

Few candidates meet all episodes: each round leaves fewer, by what is known so far, first those that keep their score on
slopes.
"""

from __future__ import annotations

import itertools
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from statistics import geometric_mean
from typing import NamedTuple

import numpy as np
import tyro
from pandas import DataFrame

from experiments.judge import Condition
from experiments.record import Row
from experiments.robot.balance_trainings import (
    CHOOSING_SEED,
    NAMES,
    OTHER_SEED,
    PUSH_100,
    PUSH_125,
    SHIPPED,
    TESTING_SEED,
    SecondTrainingExperiment,
)
from experiments.tables import shown, table, turned_table
from sarah.control.parameters import Parameters
from sarah.reports.uncertainty import standard_error
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

DIGITS = 2
"""Decimals of the shipped values."""
BEFORE, CHOSEN = "shipped before", "shipped"
"""Name of the set that ships already, and verdict about the one that will."""
HARD, NEW, LEVEL = "hard pushes", "new hard pushes", "level ground"
WEAK, FINEST = "weak servos, 100 N", "reference physics, 125 N"
SLOPES = {"slope of 4°": (4.0, 0.95), "slope of 6°": (6.0, 0.90)}
"""Slope in degrees, and smallest share of the score on level ground that a candidate keeps in its worst direction."""
DIRECTIONS = tuple(45.0 * index for index in range(8))
"""Directions that lead uphill, in degrees."""
SIGNIFICANT = 1.645
"""Number of standard errors from which a difference counts."""


class Round(NamedTuple):
    """A round of the choice. A direction of a slope has as many episodes as level ground."""

    candidates: int | None  # number of the best that take part, beside the shipped set; None for all
    episodes: Mapping[str, int]  # by condition, those of the rounds before included


ROUNDS = (
    Round(None, {HARD: 24}),
    Round(20, {HARD: 60, LEVEL: 4}),
    Round(8, {HARD: 150, LEVEL: 8, WEAK: 60}),
    Round(5, {HARD: 300, LEVEL: 8, WEAK: 100, FINEST: 24, NEW: 300}),
)
Scores = dict[tuple[Engine, str], np.ndarray]
"""Scores of the episodes that count, by engine and condition."""


@dataclass(frozen=True)
class Candidate:
    """What is known about a candidate after its last round."""

    run: str  # name of the training that recommends it
    parameters: Parameters
    round: int  # number of its last round, from 1
    scores: Scores
    shipped: Scores  # scores of the shipped set in the same episodes

    @property
    def relative(self) -> dict[tuple[Engine, str], float]:
        """Score over that of the shipped set, by engine and condition."""
        return {key: float(own.mean() / self.shipped[key].mean()) for key, own in self.scores.items()}

    @property
    def overall(self) -> float:
        """Score over that of the shipped set, over all conditions but the new pushes."""
        return geometric_mean(share for (_, condition), share in self.relative.items() if condition != NEW)

    @property
    def lost_on(self) -> str:
        """The gentlest slope on which it keeps too little; empty if there is none."""
        lost = (
            condition
            for (engine, condition), scores in self.scores.items()
            if condition in SLOPES and scores.mean() < SLOPES[condition][1] * self.scores[engine, LEVEL].mean()
        )
        return min(lost, default="")

    @property
    def loses_to_shipped(self) -> bool:
        """Whether it scores worse than the shipped set under new hard pushes, in either engine."""
        changes = [own - self.shipped[key] for key, own in self.scores.items() if key[1] == NEW]
        return any(change.mean() < -SIGNIFICANT * standard_error(change[np.newaxis]) for change in changes)


@dataclass(frozen=True)
class Shipping(SecondTrainingExperiment):
    """The choice of the shipped V1 to V4."""

    rounds: tyro.conf.Suppress[tuple[Round, ...]] = ROUNDS  # sizes of the rounds

    def cases(self) -> list[Row]:
        """The engines, all of which the rule looks at in each case."""
        return [{"engine": engine} for engine in self.engines]

    def rows(self, engine: Engine) -> Iterator[Row]:
        """The conditions that each candidate met in an engine, the best candidate first."""
        candidates = self.judged(first=engine)
        chosen = self.choice(candidates)
        for candidate in candidates:
            shared = {
                "run": candidate.run,
                **dict(zip(NAMES, candidate.parameters, strict=True)),
                "verdict": CHOSEN if candidate is chosen else self.verdict(candidate),
                "overall": candidate.overall,
            }
            for (met_in, condition), relative in candidate.relative.items():
                if met_in == engine:
                    episodes = candidate.scores[engine, condition].size
                    yield {**shared, "condition": condition, "episodes": episodes, "relative": relative}

    def choice(self, candidates: Sequence[Candidate]) -> Candidate:
        """The candidate that the package ships."""
        passing = [candidate for candidate in candidates if self.verdict(candidate) == "passes"]
        shipped = next(candidate for candidate in candidates if candidate.parameters == SHIPPED)
        return max(passing, key=lambda candidate: candidate.overall, default=shipped)

    def verdict(self, candidate: Candidate) -> str:
        """Why a candidate is not chosen, or that it passes."""
        if candidate.lost_on:
            return f"loses on a {candidate.lost_on}"
        if candidate.round < len(self.rounds):
            return f"out after round {candidate.round}"
        return f"worse under {NEW}" if candidate.loses_to_shipped else "passes"

    def judged(self, first: Engine) -> list[Candidate]:
        """All candidates, the best first.

        :param first: engine that each round begins with; a process that begins with another one shares the work
        """
        names = {SHIPPED: BEFORE}
        for engine in self.engines:
            for name, (recommended, _) in self.trainings(engine).items():
                names.setdefault(rounded(recommended), f"{name}, {engine}")
        ranked = list(names)
        known: dict[Parameters, Candidate] = {}
        for number, size in enumerate(self.rounds, start=1):
            part = list(dict.fromkeys([SHIPPED, *ranked[: size.candidates]]))
            found: dict[Parameters, Scores] = {one: {} for one in part}
            for engine, one in itertools.product(sorted(self.engines, key=lambda one: one != first), part):
                found[one] |= self.scores(one, engine, size.episodes)
            known |= {one: Candidate(names[one], one, number, found[one], found[SHIPPED]) for one in part}
            part.sort(key=lambda one: (not known[one].lost_on, known[one].overall), reverse=True)
            ranked = [*part, *(one for one in ranked if one not in part)]
        return [known[one] for one in ranked]

    def scores(self, parameters: Parameters, engine: Engine, episodes: Mapping[str, int]) -> Scores:
        """Scores of a candidate in an engine; of a slope those in the worst direction."""
        found = {}
        for name, asked in self.conditions(engine, episodes).items():
            parts = [[one] for one in asked] if name in SLOPES else [asked]
            found[engine, name] = min((self.judge.scores(parameters, part) for part in parts), key=np.mean)
        return found

    def conditions(self, engine: Engine, episodes: Mapping[str, int]) -> dict[str, list[Condition]]:
        """Conditions that a candidate meets in an engine, with their episodes; of a slope those of each direction."""
        counts = Counter(episodes)

        def slope(name: str, degrees: float) -> list[Condition]:
            terrains = {uphill: Terrain((degrees, degrees), (uphill, uphill)) for uphill in DIRECTIONS}
            return [
                self.condition(f"{name}, uphill {uphill:g}", engine, OTHER_SEED, counts[LEVEL], terrain=terrain)
                for uphill, terrain in terrains.items()
            ]

        servos = {"randomisation": Randomisation(actuator_bandwidth=(15.0, 15.0))}
        asked = {
            HARD: self.pushes(engine, CHOOSING_SEED, counts[HARD]),
            NEW: self.pushes(engine, TESTING_SEED, counts[NEW]),
            LEVEL: [self.condition(LEVEL, engine, OTHER_SEED, counts[LEVEL])],
            **{name: slope(name, degrees) for name, (degrees, _) in SLOPES.items()},
            WEAK: [self.condition("weak servos", engine, OTHER_SEED, counts[WEAK], PUSH_100, **servos)],
        }
        if engine == "pybullet":
            physics = {"physics": PHYSICS["reference"]}
            asked[FINEST] = [self.condition("reference", engine, CHOOSING_SEED, counts[FINEST], PUSH_125, **physics)]
        return {name: conditions for name, conditions in asked.items() if conditions[0].episodes}


def rounded(parameters: Parameters) -> Parameters:
    """Values as they are shipped."""
    return tuple(round(value, DIGITS) + 0.0 for value in parameters)  # no negative zero


FULL = Shipping()
QUICK = Shipping(time_limit=2.0, budget=5, engines=("mujoco",), seeds=1, rounds=(Round(None, {HARD: 3, LEVEL: 1}),))


def _finalists(rows: DataFrame) -> DataFrame:
    """Rows of the candidates of the last round, who met all conditions."""
    met = rows.groupby("run").condition.transform("nunique")
    return rows[met == met.max()]


def answer(rows: DataFrame) -> str:
    """Which set the rule chooses."""
    runs = rows.drop_duplicates("run")
    (chosen,) = runs[runs.verdict == CHOSEN].to_dict("records")
    values = ", ".join(shown(chosen[name], ".2f") for name in NAMES)
    origin = "shipped before" if chosen["run"] == BEFORE else f"{chosen['run']}, recommends"
    return f"Of {len(runs)} sets the rule chooses V1 to V4 = ({values}), which {origin}."


def verdicts(rows: DataFrame) -> str:
    """The candidates of the last round."""
    caption = (
        "The candidates of the last round, and their score divided by that of the set that shipped before (geometric"
        " mean over conditions)."
    )
    return table(_finalists(rows).drop_duplicates("run"), ["run", *NAMES, "overall", "verdict"], caption, overall=".3f")


def conditions(rows: DataFrame) -> str:
    """What the candidates of the last round score in each condition."""
    caption = (
        "Score of the candidates of the last round in each condition, divided by that of the set that shipped before."
    )
    return turned_table(_finalists(rows), ["engine", "condition", "episodes"], "run", "relative", caption, ".3f")
