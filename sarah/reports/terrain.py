"""The ground that the robot copes with: slopes, bumps and friction, each without a push and with one.

Every row simulates the same seeds, so the same robots meet the same bumps, higher and higher, and the same pushes.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice, product
from typing import Any

from sarah.episode.evaluation import Evaluation
from sarah.episode.push import Push, PushedConfig
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task
from sarah.episode.workers import Workers
from sarah.reports.robustness import push_of_table, rounded, wilson_interval
from sarah.robot.scale import Scale
from sarah.simulation.terrain import LARGEST_ROUGHNESS, Terrain

SLOPES = (2.0, 4.0, 6.0, 8.0)
"""Slopes, in degrees."""
UPHILL = {"right": 0.0, "forward": 90.0, "left": 180.0, "backward": 270.0}
"""Directions that lead uphill, in degrees, by name."""
ROUGHNESSES = (0.005, 0.01, 0.015, 0.02)
"""Heights of the bumps over and under the mean plane for the default robot, in m."""
FRICTIONS = (0.15, 0.25, 0.4, 0.7, 1.2)
"""Friction coefficients under both feet: ice, wet tiles, and so on to rubber."""
PUSH_NEWTONS = 75.0
"""Force of the push for the default robot, in N."""
TIME_LIMIT = 10.0
"""Time limit of the episodes, in s."""


@dataclass(frozen=True)
class Situation:
    """A ground, and the push on it.

    :param kind: what is varied: ``"slope"``, ``"roughness"`` or ``"friction"``
    :param value: slope in degrees, height of the bumps in m, or friction coefficient
    :param uphill: name of the direction that leads uphill; empty where nothing slopes
    :param newtons: force of the push, in N; 0 for none
    """

    kind: str
    value: float
    uphill: str
    newtons: float

    @property
    def terrain(self) -> Terrain:
        """Settings of the ground; all else is as by default."""
        value = (self.value, self.value)
        if self.kind == "roughness":
            return Terrain(roughness=value)
        if self.kind == "friction":
            return Terrain(friction_left=value, friction_right=value)
        degrees = UPHILL.get(self.uphill)
        return Terrain() if degrees is None else Terrain(slope_degrees=value, direction_degrees=(degrees, degrees))

    def config(self, task: Task[Any], config: EpisodeConfig) -> EpisodeConfig:
        """Settings of the situation's episodes.

        :param task: task of the episodes
        :param config: settings of which time limit and ground are replaced, and force, time and sagittal share of the
            push
        """
        usual = config.scale.scaled(Terrain())
        terrain = dataclasses.replace(self.terrain, cell=usual.cell, reach=usual.reach)
        changes: dict[str, Any] = {"terrain": terrain, "time_limit": TIME_LIMIT}
        if not (task.has_push or self.newtons):
            return task.config_of(config, **changes)
        push = config.push if isinstance(config, PushedConfig) else config.scale.scaled(Push())
        changes["push"] = push_of_table(push, self.newtons)
        if isinstance(config, PushedConfig):
            return dataclasses.replace(config, **changes)
        return PushedConfig(**(vars(config) | changes))


def situations(scale: Scale) -> Iterator[Situation]:
    """All situations of the table: each ground without a push, then with one.

    :param scale: size of the robot
    """
    for force in (0.0, rounded(PUSH_NEWTONS * scale.factor("N"))):
        yield Situation("slope", 0.0, "", force)
        yield from (Situation("slope", slope, uphill, force) for uphill, slope in product(UPHILL, SLOPES))
        yield from (
            Situation("roughness", min(LARGEST_ROUGHNESS, rounded(scale.length * height)), "", force)
            for height in ROUGHNESSES
        )
        yield from (Situation("friction", friction, "", force) for friction in FRICTIONS)


def try_terrain(
    task: Task[Any],
    parameters: tuple[float, ...],
    config: EpisodeConfig,
    seeds: Sequence[int],
    workers: Workers,
    tried: Sequence[Situation],
    progress: Callable[[Iterable[EpisodeResult]], Iterable[EpisodeResult]] = iter,
) -> dict[Situation, Evaluation]:
    """Evaluations of parameters in situations, on the same seeds.

    :param task: task of the parameters
    :param parameters: values of the task's parameters, in order
    :param config: settings of the episodes; time limit, ground, and force, time and sagittal share of the push are
        replaced
    :param seeds: seeds of the episodes
    :param workers: workers that simulate the episodes
    :param tried: situations to try
    :param progress: function that passes the results on, and may show how many there are so far
    """
    configs = [situation.config(task, config) for situation in tried]
    specs = [EpisodeSpec(parameters, seed, task, each) for each in configs for seed in seeds]
    results = iter(list(progress(workers.simulate_all(specs))))
    return {each: Evaluation(tuple(islice(results, len(seeds))), config.least_clearance) for each in tried}


def as_markdown(evaluations: Mapping[Situation, Evaluation]) -> str:
    """Markdown table with a row for each situation.

    :param evaluations: evaluations in situations
    """
    lines = [
        "| ground | push | episodes | score | steps/s | SHIFT by sensors | survival |",
        "|---" * 7 + "|",
    ]
    for situation, found in evaluations.items():
        low, high = wilson_interval(found.survivors, found.episodes)
        lines.append(
            f"| {_ground(situation)} | {situation.newtons:g} N | {found.episodes} "
            f"| {found.mean('score'):.3f} | {found.mean('steps_per_second'):.2f} "
            f"| {found.mean('shifts_by_sensors'):.0%} | {found.survival_rate:.2f} ({low:.2f} to {high:.2f}) |"
        )
    return "\n".join(lines)


def _ground(situation: Situation) -> str:
    if situation.kind == "roughness":
        return f"bumps of {1000 * situation.value:g} mm"
    if situation.kind == "friction":
        return f"friction {situation.value:g}"
    return f"{situation.value:g}° uphill {situation.uphill}" if situation.uphill else "level"
