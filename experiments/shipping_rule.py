"""The rule by which the package's V1 to V4 are chosen.

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

from collections.abc import Iterator
from dataclasses import dataclass
from statistics import geometric_mean
from typing import NamedTuple

import numpy as np
import tyro

from experiments.balance_trainings import (
    BALANCE_NAMES,
    CHOOSING_SEED,
    OTHER_SEED,
    SHIPPED,
    TESTING_SEED,
    SecondTrainingExperiment,
)
from experiments.interval import with_error
from experiments.judge import Asked, Condition, Judge
from experiments.record import Row
from sarah.control.parameters import Parameters
from sarah.episode.push import NO_PUSH
from sarah.episode.workers import Workers
from sarah.reports.uncertainty import standard_error
from sarah.simulation.engines import Engine
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

DIGITS = 2
"""Decimals of the shipped values."""
DIRECTIONS = tuple(45.0 * index for index in range(8))
"""Directions that lead uphill, in degrees."""
KEPT_ON_SLOPES = {4.0: 0.95, 6.0: 0.90}
"""Smallest share of the score on level ground that a candidate keeps in the worst direction, by slope in degrees."""
WEAK_SERVOS = Randomisation(actuator_bandwidth=(15.0, 15.0))
SIGNIFICANT = 1.645
"""Number of standard errors from which a difference counts."""


class Round(NamedTuple):
    """A round of the choice. Numbers of episodes include those of the rounds before; with 0 there is no such condition.

    :param candidates: number of the best candidates that take part, beside the shipped set; all of them if it is None
    :param pushes: number of hard pushes in each engine
    :param slopes: number of episodes on level ground, and in each direction of a slope
    :param weak_servos: number of pushes with weak servos
    :param reference: number of pushes at the reference physics
    :param new_pushes: number of hard pushes in each engine that no round has chosen by
    """

    candidates: int | None
    pushes: int
    slopes: int = 0
    weak_servos: int = 0
    reference: int = 0
    new_pushes: int = 0


ROUNDS = (Round(None, 24), Round(20, 60, 4), Round(8, 150, 8, 60), Round(5, 300, 8, 100, 24, 300))
NEW_PUSHES = "new hard pushes"
"""Name of the condition that only tests, and orders no candidates."""


class Criterion(NamedTuple):
    """A condition of the rule in one engine.

    :param name: name of the condition
    :param engine: physics engine
    :param asked: episodes
    :param is_worst: whether the worst of these counts, and not the mean of all
    """

    name: str
    engine: Engine
    asked: Asked
    is_worst: bool = False

    def scores(self, parameters: Parameters, judge: Judge) -> np.ndarray:
        """Scores of the episodes that count.

        :param parameters: values of V1 to V4
        :param judge: who keeps them
        """
        if not self.is_worst:
            return judge.scores(parameters, self.asked)
        return min((judge.scores(parameters, [one]) for one in self.asked), key=np.mean)


@dataclass(frozen=True)
class Candidate:
    """What is known about a candidate after its last round.

    :param run: name of the training that recommends it
    :param parameters: values of V1 to V4
    :param round: number of its last round, from 1
    :param criteria: conditions that it has met
    :param scores: scores of the candidate by condition
    :param shipped: scores of the shipped set in the same episodes
    """

    run: str
    parameters: Parameters
    round: int
    criteria: tuple[Criterion, ...]
    scores: tuple[np.ndarray, ...]
    shipped: tuple[np.ndarray, ...]

    @property
    def relative(self) -> list[float]:
        """Scores over those of the shipped set, by condition."""
        return [float(own.mean() / other.mean()) for own, other in zip(self.scores, self.shipped, strict=True)]

    @property
    def merit(self) -> tuple[bool, float]:
        """What orders candidates: whether it keeps its score on slopes, and its relative score without new pushes."""
        pairs = zip(self.criteria, self.relative, strict=True)
        return not self.lost_on_slopes, geometric_mean(share for one, share in pairs if one.name != NEW_PUSHES)

    @property
    def kept(self) -> list[float | None]:
        """Shares of the score on level ground, by condition; none where there is a push."""
        pairs = list(zip(self.criteria, self.scores, strict=True))
        flat = {criterion.engine: scores.mean() for criterion, scores in pairs if criterion.name == "level ground"}
        return [
            float(scores.mean() / flat[criterion.engine]) if criterion.is_worst else None for criterion, scores in pairs
        ]

    @property
    def lost_on_slopes(self) -> list[str]:
        """Slopes on which it keeps too little."""
        least = {slope_name(degrees): share for degrees, share in KEPT_ON_SLOPES.items()}
        pairs = zip(self.criteria, self.kept, strict=True)
        return [criterion.name for criterion, share in pairs if share is not None and share < least[criterion.name]]

    @property
    def loses_to_shipped(self) -> bool:
        """Whether it scores worse than the shipped set under new hard pushes, in either engine."""
        differences = [
            own - other
            for criterion, own, other in zip(self.criteria, self.scores, self.shipped, strict=True)
            if criterion.name == NEW_PUSHES
        ]
        return any(change.mean() < -SIGNIFICANT * standard_error(change[np.newaxis]) for change in differences)


@dataclass(frozen=True)
class Shipping(SecondTrainingExperiment):
    """The choice of the shipped V1 to V4.

    :param rounds: sizes of the rounds
    """

    rounds: tyro.conf.Suppress[tuple[Round, ...]] = ROUNDS

    def rows(self) -> Iterator[Row]:
        """A row for each candidate and condition that it met, the best candidate first."""
        with Workers(self.workers) as workers:
            candidates = self.judged(workers)
        chosen = self.choice(candidates)
        for candidate in candidates:
            for criterion, scores, relative, kept in zip(
                candidate.criteria, candidate.scores, candidate.relative, candidate.kept, strict=True
            ):
                yield {
                    "run": candidate.run,
                    **dict(zip(BALANCE_NAMES, candidate.parameters, strict=True)),
                    "verdict": "shipped" if candidate is chosen else self.verdict(candidate),
                    "overall": candidate.merit[1],
                    "engine": criterion.engine,
                    "condition": criterion.name,
                    "episodes": len(scores),
                    **with_error("score", scores),
                    "relative": relative,
                    "kept": kept,
                }

    def choice(self, candidates: list[Candidate]) -> Candidate:
        """The candidate that the package ships.

        :param candidates: all candidates, the best first
        """
        passing = [candidate for candidate in candidates if self.verdict(candidate) == "passes"]
        shipped = next(candidate for candidate in candidates if candidate.parameters == SHIPPED)
        return max(passing, key=lambda candidate: candidate.merit, default=shipped)

    def verdict(self, candidate: Candidate) -> str:
        """Why a candidate is not chosen, or that it passes.

        :param candidate: the candidate
        """
        if candidate.lost_on_slopes:
            return f"loses on a {candidate.lost_on_slopes[0]}"
        if candidate.round < len(self.rounds):
            return f"out after round {candidate.round}"
        return "worse under new hard pushes" if candidate.loses_to_shipped else "passes"

    def judged(self, workers: Workers) -> list[Candidate]:
        """All candidates, the best first.

        :param workers: who trains and simulates
        """
        names = {SHIPPED: "shipped before"}
        for engine in self.engines:
            for training in self.trainings(engine, workers):
                names.setdefault(rounded(training.recommended), f"{training.name}, {engine}")
        ranked = list(names)
        known: dict[Parameters, Candidate] = {}
        for number, size in enumerate(self.rounds, start=1):
            part = list(dict.fromkeys([SHIPPED, *ranked[: size.candidates]]))
            criteria = self.criteria(size)
            self.judge.simulate(part, [one for criterion in criteria for one in criterion.asked], workers)
            shipped = tuple(criterion.scores(SHIPPED, self.judge) for criterion in criteria)
            for one in part:
                scores = tuple(criterion.scores(one, self.judge) for criterion in criteria)
                known[one] = Candidate(names[one], one, number, criteria, scores, shipped)
            part.sort(key=lambda one: known[one].merit, reverse=True)
            ranked = [*part, *(one for one in ranked if one not in part)]
        return [known[one] for one in ranked]

    def criteria(self, size: Round) -> tuple[Criterion, ...]:
        """Conditions of a round, in each engine.

        :param size: size of the round
        """
        return tuple(
            criterion
            for engine in self.engines
            for criterion in self._of_engine(size, engine)
            if all(episodes for _, episodes in criterion.asked)
        )

    def _of_engine(self, size: Round, engine: Engine) -> Iterator[Criterion]:
        yield Criterion("hard pushes", engine, self.pushes(engine, CHOOSING_SEED, size.pushes))
        yield Criterion(NEW_PUSHES, engine, self.pushes(engine, TESTING_SEED, size.new_pushes))
        level = Condition("level ground", self.balance(engine, push=NO_PUSH), OTHER_SEED)
        yield Criterion(level.name, engine, [(level, size.slopes)])
        for degrees in KEPT_ON_SLOPES:
            slopes = [(self._slope(engine, degrees, uphill), size.slopes) for uphill in DIRECTIONS]
            yield Criterion(slope_name(degrees), engine, slopes, is_worst=True)
        weak = self.pushed("weak servos", engine, 100.0, OTHER_SEED, randomisation=WEAK_SERVOS)
        yield Criterion("weak servos, 100 N", engine, [(weak, size.weak_servos)])
        if engine == "pybullet":
            finest = self.pushed("reference", engine, 125.0, CHOOSING_SEED, physics=PHYSICS["reference"])
            yield Criterion("reference physics, 125 N", engine, [(finest, size.reference)])

    def _slope(self, engine: Engine, degrees: float, uphill: float) -> Condition:
        terrain = Terrain((degrees, degrees), (uphill, uphill))
        name = f"{slope_name(degrees)}, uphill {uphill:g}"
        return Condition(name, self.balance(engine, push=NO_PUSH, terrain=terrain), OTHER_SEED)


def slope_name(degrees: float) -> str:
    """Name of a slope, for people.

    :param degrees: slope, in degrees
    """
    return f"slope of {degrees:g}°"


def rounded(parameters: Parameters) -> Parameters:
    """Values as they are shipped.

    :param parameters: values that a training learned
    """
    return tuple(round(value, DIGITS) + 0.0 for value in parameters)  # no negative zero
