"""The robot in operation: parameters of the simulation on a robot that differs, frozen against renewed while it runs.

What has not been seen before the judging: the seeds of the robots. The learners' settings were chosen on others.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from statistics import mean
from typing import Any

from experiments.maker import ParallelExperiment
from experiments.interval import with_interval
from experiments.record import Row
from sarah.episode.from_mapping import from_mapping
from sarah.episode.workers import Job, Workers
from sarah.operation.settings import SHIPPED, Change, OperationConfig, Parameters
from sarah.runs.session import SessionSpec
from sarah.simulation.engines import Engine
from sarah.training.operate import SessionResult, run_session

WEAK = {"randomisation": {"actuator_bandwidth": 12.0}}
"""Servos of 12 per second, where the simulation had 40 to 50."""
ROBOTS: dict[str, dict[str, Any]] = {
    "as simulated": {},
    "weak servos": WEAK,
    "50 ms of delay, 5 kg of payload": {"payload": 5.0, "randomisation": {"delay_seconds": 0.05}},
    "slope of 6 degrees": {"terrain": {"slope_degrees": 6.0, "direction_degrees": (0.0, 360.0)}},
}
"""Settings of the robots that do not change, by name."""
CHANGING = "servos weaken at minute 5"
LEARNERS = ("none", "careful", "naf", "cma-es", "random")
SPANS = ((0.0, 3.0), (3.0, 5.0), (5.0, 8.0), (8.0, math.inf))
"""Spans of the time of operation whose means are shown, in min."""
FIRST_TUNING_SEED = 1000
"""First seed of the robots that the best known parameters are looked for on."""


@dataclass(frozen=True)
class Operation(ParallelExperiment):
    """Sessions of every learner on robots that differ, the same robots for all learners.

    :param engine: engine in which the robot runs; the parameters were learned in PyBullet
    :param seeds: number of sessions of the careful learner, and of none
    :param other_seeds: number of sessions of the others
    :param minutes: duration of a session, in min
    :param best_seeds: number of long sessions that look for the best known parameters of a robot
    :param best_minutes: duration of these, in min
    """

    engine: Engine = "mujoco"
    seeds: int = 20
    other_seeds: int = 10
    minutes: float = 10.0
    best_seeds: int = 4
    best_minutes: float = 30.0

    def rows(self) -> Iterator[Row]:
        """A row for each robot and learner."""
        with Workers(self.workers) as workers:
            jobs = {
                (robot, learner): self._sessions(workers, robot, learner, [SHIPPED] * self._count(learner))
                for robot in (*ROBOTS, CHANGING)
                for learner in LEARNERS
            }
            for robot in (*ROBOTS, CHANGING):
                frozen = [job.result() for job in jobs[robot, "none"]]
                for learner in LEARNERS:
                    found = [job.result() for job in jobs[robot, learner]]
                    yield _row(robot, learner, found, frozen) | self._left(workers, robot, found)
                if robot in ROBOTS:
                    best = self._best_known(robot, workers)
                    found = [job.result() for job in self._sessions(workers, robot, "none", [best] * self.seeds)]
                    yield _row(robot, "best known, frozen", found, frozen) | {"score_of_last_parameters": ""}

    def _count(self, learner: str) -> int:
        return self.seeds if learner in ("none", "careful") else self.other_seeds

    def _sessions(
        self, workers: Workers, robot: str, learner: str, first: Sequence[Parameters], minutes: float | None = None
    ) -> list[Job]:
        """Sessions on the first seeds, one for each of the parameters that they begin with."""
        config = self._config(robot, self.minutes if minutes is None else minutes)
        specs = [SessionSpec(parameters, learner, seed, config) for seed, parameters in enumerate(first)]
        return [workers.submit(run_session, spec) for spec in specs]

    def _left(self, workers: Workers, robot: str, found: list[SessionResult]) -> Row:
        """Score of the parameters that sessions end with, frozen on the same robots as they are in the end.

        They run for a fifth of the session's time, and for at least the shortest time of an operation.
        """
        in_the_end = "weak servos" if robot == CHANGING else robot
        last = [session.parameters for session in found]
        jobs = self._sessions(workers, in_the_end, "none", last, max(0.1, self.minutes / 5.0))
        return {"score_of_last_parameters": mean(job.result().mean_score() for job in jobs)}

    def _config(self, robot: str, minutes: float) -> OperationConfig:
        base = OperationConfig()
        changes = (Change(self.minutes / 2.0, WEAK),) if robot == CHANGING else ()
        settings = {"engine": self.engine, **ROBOTS.get(robot, {})}
        return OperationConfig(from_mapping(base.robot, settings), minutes=minutes, changes=changes)

    def _best_known(self, robot: str, workers: Workers) -> Parameters:
        """Of what long sessions on other seeds end with, the parameters that do best on these seeds."""
        seeds = range(FIRST_TUNING_SEED, FIRST_TUNING_SEED + self.best_seeds)
        long, short = (self._config(robot, minutes) for minutes in (self.best_minutes, min(2.0, self.best_minutes)))
        sessions = [workers.submit(run_session, SessionSpec(SHIPPED, "careful", seed, long)) for seed in seeds]
        candidates = [SHIPPED, *(job.result().parameters for job in sessions)]
        judged = [
            [workers.submit(run_session, SessionSpec(candidate, "none", seed, short)) for seed in seeds]
            for candidate in candidates
        ]
        scores = [mean(job.result().mean_score() for job in running) for running in judged]
        return candidates[scores.index(max(scores))]


def _row(robot: str, learner: str, found: list[SessionResult], frozen: list[SessionResult]) -> Row:
    gains = [one.mean_score() - other.mean_score() for one, other in zip(found, frozen, strict=False)]
    row: dict[str, object] = {"robot": robot, "learner": learner, "sessions": len(found)}
    row["score"] = mean(session.mean_score() for session in found)
    for begin, end in SPANS:
        scores = [score for session in found if not math.isnan(score := session.mean_score(begin, end))]
        name = f"score_from_{begin:g}" if math.isinf(end) else f"score_{begin:g}_to_{end:g}"
        row[f"{name}_min"] = mean(scores) if scores else ""
    row |= with_interval("gain", gains)
    row["falls"] = mean(session.falls for session in found)
    row["most_falls"] = max(session.falls for session in found)
    return row
