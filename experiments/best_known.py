"""The best known V1 to V4 of an engine: a search around the shipped set and around what trainings recommend.

Successive halving: all candidates meet the same few pushes, the best of them more, and the last ones as many as the
judge has. These pushes are of the judge's kind but of other seeds, so the judge's estimate of the winner is unbiased.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from experiments.balance_trainings import CHOOSING_SEED, JUDGING_SEED, SHIPPED, SecondTrainingExperiment, Training
from experiments.judge import Asked
from sarah.control.parameters import BALANCE_PARAMETERS, Parameters
from sarah.episode.workers import Executor
from sarah.simulation.engines import Engine

DEVIATION = (0.3, 0.8, 0.3, 0.8)
"""Standard deviation of candidates around a known set; what V2 and V4 do shows over longer distances."""
ROUNDS = ((1, 9), (4, 24), (16, 87), (32, 300))
"""Divisor of the number of candidates that each round leaves, and number of pushes that these have met by its end."""


@dataclass(frozen=True)
class BestKnownExperiment(SecondTrainingExperiment):
    """Options of an experiment that compares sets with the best known one of an engine.

    :param judging: number of pushes that judge a set, and of those that choose the best one
    :param candidates: number of sets that the search for the best known set begins with
    """

    judging: int = 300
    candidates: int = 256

    def judging_pushes(self, engine: Engine) -> Asked:
        """Pushes that judge.

        :param engine: physics engine
        """
        return self.pushes(engine, JUDGING_SEED, self.judging)


class Found(NamedTuple):
    """Sets that the search was for.

    :param best: best known set
    :param recommended: best of the sets that trainings recommend
    :param drawn: best of the sets that the search has drawn
    """

    best: Parameters
    recommended: Parameters
    drawn: Parameters


def best_known(options: BestKnownExperiment, engine: Engine, trainings: Sequence[Training], workers: Executor) -> Found:
    """Search for the best set of an engine. An outcome that is kept is not simulated again.

    :param options: size of the search
    :param engine: physics engine
    :param trainings: trainings in this engine
    :param workers: who simulates
    """
    recommended = [training.recommended for training in trainings]
    known = dict.fromkeys([SHIPPED, *recommended, *(training.mu for training in trainings)])
    drawn = around([SHIPPED, *recommended], max(1, options.candidates - len(known)))

    def scores(sets: Sequence[Parameters], episodes: int) -> list[float]:
        asked = options.pushes(engine, CHOOSING_SEED, min(episodes, options.judging))
        options.judge.simulate(sets, asked, workers)
        return [float(options.judge.scores(one, asked).mean()) for one in sets]

    candidates = list(dict.fromkeys([*known, *drawn]))
    rounds = [(max(1, len(candidates) // divisor), episodes) for divisor, episodes in ROUNDS]
    ranked = successive_halving(candidates, rounds, scores)
    first_of = [next(one for one in ranked if one in group) for group in (recommended, drawn)]
    return Found(ranked[0], *first_of)


def successive_halving(
    candidates: Sequence[Parameters],
    rounds: Sequence[tuple[int, int]],
    scores: Callable[[Sequence[Parameters], int], Sequence[float]],
) -> list[Parameters]:
    """Candidates, the best first.

    :param candidates: sets to choose from
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
    """Sets drawn around known ones, within the box.

    :param centres: known sets
    :param count: number of sets to draw
    """
    generator = np.random.default_rng(0)
    low, high = ([getattr(parameter, end) for parameter in BALANCE_PARAMETERS] for end in ("low", "high"))
    drawn = []
    for _ in range(count):
        centre = centres[int(generator.integers(len(centres)))]
        drawn.append(tuple(map(float, generator.normal(centre, DEVIATION).clip(low, high))))
    return drawn
