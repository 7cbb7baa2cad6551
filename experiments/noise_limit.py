"""How much of the balance race is noise: what would be recommended by an algorithm that knows where to look."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean

import numpy as np

from experiments.experiment import OnWorkers
from experiments.record import Row
from experiments.trainings import EPISODES
from sarah.episode.evaluation import evaluate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, disturbances_of
from sarah.episode.workers import Workers
from sarah.training.recommendation import Parameters, Tried, merit

GOOD = PARAMETER_SETS["balance"].spec.parameters
"""Known good V1 to V4: those that the package ships."""
DEVIATION = 0.3
"""Standard deviation of the draws around them, in the units of V."""
UNSEEN = 5000
"""First seed of the judging episodes."""
CONFIG = dataclasses.replace(EPISODES["balance"], engine="mujoco")


@dataclass(frozen=True)
class NoiseLimit(OnWorkers):
    """All of a budget is drawn around known good V1 to V4, and what is recommended of it is judged beside these.

    :param episodes: number of draws: the budget of the race without its closing comparison
    :param seeds: number of recommendations
    :param judged: number of unseen episodes that judge
    """

    episodes: int = 135
    seeds: int = 3
    judged: int = 48

    def rows(self) -> Iterator[Row]:
        """A row for the good parameters, one for V = 0, and one for what is recommended."""
        assert BALANCE.neutral is not None
        with Workers(self.workers) as workers:
            yield row("shipped", [self._score(GOOD, workers)])
            yield row("V = 0", [self._score(BALANCE.neutral, workers)])
            scores = [self._score(self._recommended(seed, workers), workers) for seed in range(self.seeds)]
            yield row(f"recommended after {self.episodes} episodes around those that are shipped", scores)

    def _score(self, parameters: Parameters, workers: Workers) -> float:
        return evaluate(BALANCE.name, parameters, CONFIG, range(UNSEEN, UNSEEN + self.judged), workers).mean("score")

    def _recommended(self, seed: int, workers: Workers) -> Parameters:
        """What is recommended after some episodes around the good parameters."""
        generator = np.random.default_rng(seed)
        low, high = ([getattr(parameter, end) for parameter in BALANCE.parameters] for end in ("low", "high"))
        drawn = generator.normal(GOOD, DEVIATION, (self.episodes, len(GOOD))).clip(low, high)
        specs = [
            EpisodeSpec(tuple(map(float, v)), int(generator.integers(FIRST_TRAINING_SEED, 2**32)), BALANCE.name, CONFIG)
            for v in drawn
        ]
        results = workers.simulate_all(specs)
        tried = Tried(BALANCE)
        for spec, result in zip(specs, results, strict=True):
            tried.append(spec.parameters, merit(result), disturbances_of(spec))
        return tried.best(specs[0].parameters)


def row(controller: str, scores: list[float]) -> Row:
    """A row; of several scores the mean, the lowest and the highest.

    :param controller: name of the controller
    :param scores: mean scores of its parameters
    """
    ends = (min(scores), max(scores)) if len(scores) > 1 else (None, None)
    return {"controller": controller, "score": mean(scores), "score_low": ends[0], "score_high": ends[1]}
