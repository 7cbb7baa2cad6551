"""Whether the box around the start ends episodes that the robot would have saved: the same pushes in a wider box."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import get_args

from experiments.conditions import LATERAL, LEARNED, SAGITTAL, Situation, simulate
from experiments.maker import ParallelExperiment, survival
from experiments.record import Row
from sarah.episode.ending import paper_ending
from sarah.episode.evaluation import Evaluation
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE
from sarah.episode.tick import Tick
from sarah.episode.workers import Workers
from sarah.simulation.engines import Engine

PUSHES = (
    Situation("115 N sagittal", newtons=115.0, push_degrees=SAGITTAL),
    Situation("125 N sagittal", newtons=125.0, push_degrees=SAGITTAL),
    Situation("125 N lateral", newtons=125.0, push_degrees=LATERAL),
)


def ending_of_wide_box(tick: Tick, config: EpisodeConfig) -> str | None:
    """End an episode as the paper does, in a box twice as wide: the box then judges half of the displacement.

    :param tick: what is known at the end of a control tick
    :param config: settings of the episode
    """
    (x, y, z), (start_x, start_y, start_z) = tick.torso.position, tick.start
    return paper_ending(tick._replace(start=((x + start_x) / 2, (y + start_y) / 2, (z + start_z) / 2)), config)


BOXES = {"0.25 m": BALANCE, "0.5 m": replace(BALANCE, name="balance_in_wide_box", ending=ending_of_wide_box)}
"""Tasks by the distance from the start that ends an episode."""


@dataclass(frozen=True)
class BoxLimit(ParallelExperiment):
    """Pushes that some robots do not survive, in the paper's box and in one twice as wide, with the shipped parameters.

    :param pushes: number of pushes of a row
    :param time_limit: time limit, in s; a push comes at 2 to 3 s
    """

    pushes: int = 200
    time_limit: float = 8.0

    def rows(self) -> Iterator[Row]:
        """A row for each engine, push and box."""
        with Workers(self.workers) as workers:
            for engine in get_args(Engine):
                config = BALANCE.config_of(LEARNED.config, engine=engine, time_limit=self.time_limit)
                for push in PUSHES:
                    for box, task in BOXES.items():
                        jobs = [
                            workers.submit(simulate, push, "learned", index, self.pushes, config, task)
                            for index in range(self.pushes)
                        ]
                        found = Evaluation(tuple(job.result() for job in jobs))
                        yield {
                            "engine": engine,
                            "push": push.name,
                            "box": box,
                            **survival(found),
                            **{ending: count(found, ending) for ending in ("left_box", "fell")},
                            "final_distance_cm": 100.0 * found.median("drift"),
                        }


def count(found: Evaluation, ending: str) -> int:
    """Number of episodes that ended in a way.

    :param found: episodes
    :param ending: way in which they ended
    """
    return sum(result.termination == ending for result in found.results)
