"""How good Second Trainings are: each training beside V = 0, the shipped set and the best known one of its engine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from experiments.balance_trainings import BALANCE_NAMES, JUDGING_SEED, SEEDS_OF_A_KIND, SHIPPED, Training
from experiments.best_known import BestKnownExperiment, best_known
from experiments.interval import crossed_bootstrap, ratio, with_error
from experiments.judge import Asked
from experiments.record import Row, cell
from sarah.control.parameters import Parameters
from sarah.episode.tasks import BALANCE
from sarah.episode.workers import Executor, Workers
from sarah.simulation.engines import Engine

ENOUGH = 0.95
"""Share of the best known score from which a training counts in ``at_95``."""


@dataclass(frozen=True)
class SecondTraining(BestKnownExperiment):
    """Second Trainings by NAF: what each recommends, what its network says, and how both do.

    :param surviving: number of pushes of 100 N by which survival is judged
    """

    surviving: int = 100

    def rows(self) -> Iterator[Row]:
        """A row for V = 0, for the shipped set, for the best known one and for each training, in each engine."""
        assert BALANCE.neutral is not None
        with Workers(self.workers) as workers:
            for engine in self.engines:
                trainings = self.told(engine, workers)
                best = best_known(self, engine, trainings, workers).best
                others = {"V = 0": BALANCE.neutral, "shipped": SHIPPED, "best known": best}
                for asked in (self.judging_pushes(engine), self.survivable_pushes(engine)):
                    self.judge.simulate(others.values(), asked, workers)
                for run, parameters in others.items():
                    yield self._row(engine, run, parameters, best)
                for training in trainings:
                    yield self._row(engine, training.name, training.recommended, best, training.mu)

    def told(self, engine: Engine, workers: Executor) -> list[Training]:
        """All trainings of an engine, each with a line about its score as soon as this is known.

        :param engine: physics engine
        :param workers: who trains
        """
        trainings = []
        for training in self.trainings(engine, workers):
            score, mu_score = (self.scores(engine, one).mean() for one in (training.recommended, training.mu))
            print(f"{engine}, {training.name}: score {cell(float(score))}, mu {cell(float(mu_score))}", flush=True)
            trainings.append(training)
        return trainings

    def training(self, engine: Engine, seed: int) -> Training:
        """A training, run or resumed in this process unless it is there, and judged.

        :param engine: physics engine
        :param seed: seed of the training
        """
        training = super().training(engine, seed)
        for one in (training.recommended, training.mu):
            for asked in (self.judging_pushes(engine), self.survivable_pushes(engine)):
                self.judge.scores(one, asked)
        return training

    def survivable_pushes(self, engine: Engine) -> Asked:
        """Pushes of 100 N from everywhere, most of which a good set survives.

        :param engine: physics engine
        """
        return [(self.pushed("100 N", engine, 100.0, JUDGING_SEED + 2 * SEEDS_OF_A_KIND), self.surviving)]

    def scores(self, engine: Engine, parameters: Parameters) -> np.ndarray:
        """Scores under the pushes that judge.

        :param engine: physics engine
        :param parameters: values of V1 to V4
        """
        return self.judge.scores(parameters, self.judging_pushes(engine))

    def survival(self, engine: Engine, parameters: Parameters) -> float:
        """Share of the pushes of 100 N that the robot survives.

        :param engine: physics engine
        :param parameters: values of V1 to V4
        """
        return float(self.judge.survival(parameters, self.survivable_pushes(engine)).mean())

    def _row(
        self, engine: Engine, run: str, parameters: Parameters, best: Parameters, mu: Parameters | None = None
    ) -> Row:
        scores, best_scores = self.scores(engine, parameters), self.scores(engine, best)
        mu_scores = None if mu is None else self.scores(engine, mu)
        return {
            "engine": engine,
            "run": run,
            **dict(zip(BALANCE_NAMES, parameters, strict=True)),
            **with_error("score", scores),
            **ratio("of_best", scores, best_scores),
            "survival_100": self.survival(engine, parameters),
            **{f"mu_{name}": mu and mu[index] for index, name in enumerate(BALANCE_NAMES)},
            "mu_score": None if mu_scores is None else float(mu_scores.mean()),
            "mu_of_best": None if mu_scores is None else float(mu_scores.mean() / best_scores.mean()),
            "mu_survival_100": mu and self.survival(engine, mu),
        }


@dataclass(frozen=True)
class SecondTrainingSummary(SecondTraining):
    """What the trainings of an engine have in common. Nothing is simulated that ``second_training`` has kept."""

    def rows(self) -> Iterator[Row]:
        """A row for each engine, for what trainings recommend and for what their networks say."""
        with Workers(self.workers) as workers:
            for engine in self.engines:
                trainings = self.told(engine, workers)
                best = best_known(self, engine, trainings, workers).best
                self.judge.simulate([best], self.judging_pushes(engine), workers)
                best_scores = self.scores(engine, best)
                kinds = {
                    "recommended": [training.recommended for training in trainings],
                    "mu": [training.mu for training in trainings],
                }
                for kind, sets in kinds.items():
                    survival = [self.survival(engine, one) for one in sets]
                    yield {
                        "engine": engine,
                        "kind": kind,
                        "trainings": len(sets),
                        **summary([self.scores(engine, one) for one in sets], best_scores),
                        "survival_100": float(np.mean(survival)),
                        "lowest_survival_100": min(survival),
                    }


def summary(scores: Sequence[np.ndarray], best_scores: np.ndarray) -> Row:
    """Columns about trainings of one kind, with 95 % intervals over both their seeds and the pushes.

    :param scores: scores of each training
    :param best_scores: scores of the best known set under the same pushes
    """
    of_all = np.array(scores)

    def shares(trainings: np.ndarray, pushes: np.ndarray) -> np.ndarray:
        return of_all[np.ix_(trainings, pushes)].mean(axis=1) / best_scores[pushes].mean()

    def mean_share(trainings: np.ndarray, pushes: np.ndarray) -> float:
        return float(shares(trainings, pushes).mean())

    def number_at_95(trainings: np.ndarray, pushes: np.ndarray) -> float:
        return float((shares(trainings, pushes) >= ENOUGH).sum())

    everything = np.arange(len(of_all)), np.arange(len(best_scores))
    mean_low, mean_high = crossed_bootstrap(mean_share, *of_all.shape)
    number_low, number_high = crossed_bootstrap(number_at_95, *of_all.shape)
    return {
        "of_best": mean_share(*everything),
        "of_best_low": mean_low,
        "of_best_high": mean_high,
        "at_95": int(number_at_95(*everything)),
        "at_95_low": int(number_low),
        "at_95_high": int(number_high),
        "lowest_of_best": float(shares(*everything).min()),
    }
