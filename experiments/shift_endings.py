"""What ends SHIFT: which of its three conditions comes last, tilt, rate or load, while the robot steps steadily."""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from typing import Any

from experiments.engines import ENGINES
from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.control.pattern_generator import PatternGenerator, Phase, PhaseChange
from sarah.episode.episode import Episode
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.spec import FIRST_EVALUATION_SEED, EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import Workers
from sarah.robot.description import ACTUATED_JOINTS

CONDITIONS = ("tilt", "rate", "load")
"""Conditions that end SHIFT together."""
ENDINGS = (*CONDITIONS, "together", "time_out")
"""What ends a SHIFT: the condition that came last, several in the same tick, or the time-out."""


class Watched(PatternGenerator):
    """A pattern generator that remembers since when each condition of SHIFT has held, and how each SHIFT ended."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        super().__init__(*arguments, **keywords)
        self.endings: list[str] = []
        self._held = dict.fromkeys(CONDITIONS, 0)

    def _phase_change(self) -> PhaseChange | None:
        if self.phase is Phase.SHIFT:
            parameters, constants = self.parameters, self.constants
            now = {
                "tilt": self.tilt > parameters.P2,
                "rate": self.rate > constants.rate_scale * parameters.P3,
                "load": self.hips.loads[self.stance] > constants.pad_threshold,
            }
            self._held = {name: self._held[name] + 1 if now[name] else 0 for name in CONDITIONS}
        change = super()._phase_change()
        if change is not None:
            if change.ended is Phase.SHIFT:
                self.endings.append(self._last() if change.by_sensors else "time_out")
            self._held = dict.fromkeys(CONDITIONS, 0)
        return change

    def _last(self) -> str:
        shortest = min(self._held.values())
        last = [name for name in CONDITIONS if self._held[name] == shortest]
        return last[0] if len(last) == 1 else "together"


@dataclass(frozen=True)
class ShiftEndings(ParallelExperiment):
    """The shipped parameters without a push, in both engines, with their own P3 and with others.

    :param p3: values of P3 to try beside a set's own
    :param episodes: number of episodes of each set in each engine
    :param time_limit: time limit of an episode, in s
    :param steady_from: simulated time from which SHIFTs count, in s: the first steps are others
    """

    p3: tuple[float, ...] = (2.0,)
    episodes: int = 10
    time_limit: float = 20.0
    steady_from: float = 4.0

    def rows(self) -> Iterator[Row]:
        """A row for each set, value of P3 and engine."""
        with Workers(self.workers) as workers:
            for name, shipped in PARAMETER_SETS.items():
                own = stepping_of(shipped.spec)
                for p3, engine in product((own[2], *self.p3), ENGINES):
                    config = dataclasses.replace(shipped.spec.config, engine=engine, time_limit=self.time_limit)
                    spec = with_stepping(dataclasses.replace(shipped.spec, config=config), (*own[:2], p3, *own[3:]))
                    seeds = range(FIRST_EVALUATION_SEED, FIRST_EVALUATION_SEED + self.episodes)
                    specs = [dataclasses.replace(spec, seed=seed) for seed in seeds]
                    jobs = [workers.submit(endings, spec, self.steady_from) for spec in specs]
                    found = Counter(ending for job in jobs for ending in job.result())
                    shares = {f"{ending}_share": found[ending] / max(1, found.total()) for ending in ENDINGS}
                    yield {"set": name, "P3": p3, "engine": engine, "shifts": found.total(), **shares}


def stepping_of(spec: EpisodeSpec) -> tuple[float, ...]:
    """Values of P1 to P5, of either task.

    :param spec: specification of an episode
    """
    return spec.config.stepping if isinstance(spec.config, BalanceConfig) else spec.parameters


def with_stepping(spec: EpisodeSpec, stepping: tuple[float, ...]) -> EpisodeSpec:
    """The same episode with other P1 to P5, and without a push.

    :param spec: specification of an episode
    :param stepping: values of P1 to P5
    """
    if not isinstance(spec.config, BalanceConfig):
        return dataclasses.replace(spec, parameters=stepping)
    config = dataclasses.replace(spec.config, stepping=stepping, push=Push(newtons=(0.0, 0.0)))
    return dataclasses.replace(spec, config=config)


def endings(spec: EpisodeSpec, steady_from: float) -> list[str]:
    """How each SHIFT of an episode ended.

    :param spec: specification of the episode
    :param steady_from: simulated time from which they count, in s
    """
    with Episode.of(spec) as episode:
        robot = episode.robot
        limits = [robot.description.limits[joint] for joint in ACTUATED_JOINTS]
        dt, constants = spec.config.physics.control_dt, spec.config.controller
        robot.generator = generator = Watched(robot.generator.parameters, dt=dt, limits=limits, constants=constants)
        episode.stand()
        episode.start(spec.parameters)
        first = 0
        while episode.termination is None:
            if robot.simulation.time < steady_from:
                first = len(generator.endings)
            episode.tick()
        return generator.endings[first:]
