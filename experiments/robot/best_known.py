"""Which V1 to V4 are the best in each engine, of all that trainings recommend and a search draws?

The search draws sets around the shipped one and around what trainings recommend. In each of its rounds fewer sets meet
more hard pushes. Pushes of other seeds judge the sets later: those that judge have chosen nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from pandas import DataFrame

from experiments.record import Row
from experiments.robot.balance_trainings import CHOOSING_SEED, NAMES, SHIPPED, SecondTrainingExperiment
from experiments.tables import table
from sarah.control.parameters import BALANCE_PARAMETERS, Parameters
from sarah.episode.tasks import BALANCE
from sarah.simulation.engines import Engine

NEUTRAL, BEST = "V = 0", "best known"
KNOWN = (NEUTRAL, "shipped", "best training", "search winner", BEST)
"""Sets that the trainings are compared with."""
ROUNDS = ((1, 9), (4, 24), (16, 87), (32, 300))
"""Divisor of the number of candidates that each round of the search leaves, and number of pushes met by its end."""
DEVIATION = (0.3, 0.8, 0.3, 0.8)
"""Standard deviation of candidates around a known set; what V2 and V4 do shows over longer distances."""


@dataclass(frozen=True)
class SearchExperiment(SecondTrainingExperiment):
    """Options of an experiment that searches for the best set."""

    candidates: int = 256  # number of sets that the search for the best known set begins with
    choosing: int = 300  # number of pushes that choose it

    def found(self, engine: Engine) -> dict[str, Parameters]:
        """The sets that trainings are compared with, by name. The search keeps all outcomes."""
        assert BALANCE.neutral is not None
        trainings = self.trainings(engine)
        recommended = [one for one, _ in trainings.values()]
        known = list(dict.fromkeys([SHIPPED, *recommended, *(mu for _, mu in trainings.values())]))
        drawn = around([SHIPPED, *recommended], max(1, self.candidates - len(known)))

        def scores(sets: Sequence[Parameters], episodes: int) -> list[float]:
            asked = self.pushes(engine, CHOOSING_SEED, min(episodes, self.choosing))
            return [float(self.judge.scores(one, asked).mean()) for one in sets]

        candidates = list(dict.fromkeys([*known, *drawn]))
        rounds = [(max(1, len(candidates) // divisor), episodes) for divisor, episodes in ROUNDS]
        ranked = successive_halving(candidates, rounds, scores)
        first_of = [next(one for one in ranked if one in group) for group in (recommended, drawn, ranked)]
        return dict(zip(KNOWN, [BALANCE.neutral, SHIPPED, *first_of], strict=True))


@dataclass(frozen=True)
class BestKnown(SearchExperiment):
    """The sets that trainings are compared with."""

    def cases(self) -> list[Row]:
        """The engines, which share no search."""
        return [{"engine": engine} for engine in self.engines]

    def rows(self, engine: Engine) -> Iterator[Row]:
        """The sets that trainings are compared with."""
        for run, parameters in self.found(engine).items():
            yield {"run": run, **dict(zip(NAMES, parameters, strict=True))}


FULL = BestKnown()
QUICK = BestKnown(time_limit=2.0, budget=5, engines=("mujoco",), seeds=1, candidates=4, choosing=3)


def sets(rows: DataFrame) -> str:
    """The sets."""
    caption = "V1 to V4 that the trainings are compared with; P1 to P5 are the shipped ones."
    return table(rows, ["engine", "run", *NAMES], caption)


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
