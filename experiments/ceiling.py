"""How much better than shipped V1 to V4 could be: the best known set of each engine, found by a search."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from experiments.balance_trainings import BALANCE_NAMES, SHIPPED
from experiments.best_known import BestKnownExperiment, best_known
from experiments.interval import ratio, with_error
from experiments.record import Row
from sarah.episode.workers import Workers


@dataclass(frozen=True)
class Ceiling(BestKnownExperiment):
    """The shipped set, the best training and what a search found, judged by pushes that chose none of them."""

    def rows(self) -> Iterator[Row]:
        """A row for each engine and set."""
        with Workers(self.workers) as workers:
            for engine in self.engines:
                found = best_known(self, engine, list(self.trainings(engine, workers)), workers)
                asked = self.judging_pushes(engine)
                sets = {
                    "shipped": SHIPPED,
                    "best training": found.recommended,
                    "search winner": found.drawn,
                    "best known": found.best,
                }
                self.judge.simulate(sets.values(), asked, workers)
                best = self.judge.scores(found.best, asked)
                for run, parameters in sets.items():
                    scores = self.judge.scores(parameters, asked)
                    yield {
                        "engine": engine,
                        "run": run,
                        **dict(zip(BALANCE_NAMES, parameters, strict=True)),
                        "pushes": self.judging,
                        **with_error("score", scores),
                        **ratio("of_best", scores, best),
                    }
