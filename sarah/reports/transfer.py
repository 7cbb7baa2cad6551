"""The transfer of learned parameters from one physics engine to the others, on the same seeds and pushes."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, product
from typing import Any, get_args

from sarah.episode.evaluation import Evaluation
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task
from sarah.episode.workers import Workers
from sarah.reports.markdown import plain_text
from sarah.simulation.engines import Engine

ENGINES: tuple[Engine, ...] = get_args(Engine)


@dataclass(frozen=True)
class LearnedParameters:
    """Learned parameters of a training.

    :param name: name of the run folder, or the parameters themselves
    :param task: task that owns the parameters
    :param parameters: values of P1 to P5, or of V1 to V4
    :param config: settings of the episodes; its engine is the one that they were learned in
    """

    name: str
    task: Task[Any]
    parameters: tuple[float, ...]
    config: EpisodeConfig


@dataclass(frozen=True)
class Transfer:
    """Evaluations of learned parameters in every engine.

    :param learned: learned parameters
    :param evaluations: evaluations by engine
    """

    learned: LearnedParameters
    evaluations: dict[Engine, Evaluation]

    @property
    def kept(self) -> float:
        """Lowest score in another engine, as a share of that in the engine of the training; 0 if the latter is 0."""
        scores = {engine: evaluation.mean("score") for engine, evaluation in self.evaluations.items()}
        at_home = scores.pop(self.learned.config.engine)
        return min(scores.values()) / at_home if at_home else 0.0


def transfer(many: Sequence[LearnedParameters], seeds: Sequence[int], workers: Workers) -> list[Transfer]:
    """Evaluate learned parameters in every engine.

    :param many: learned parameters of several trainings
    :param seeds: seeds of the episodes, the same for all
    :param workers: workers that simulate the episodes
    """
    specs = [
        EpisodeSpec(learned.parameters, seed, learned.task, dataclasses.replace(learned.config, engine=engine))
        for learned, engine, seed in product(many, ENGINES, seeds)
    ]
    results = iter(list(workers.simulate_all(specs)))
    return [
        Transfer(
            one,
            {engine: Evaluation(tuple(islice(results, len(seeds))), one.config.least_clearance) for engine in ENGINES},
        )
        for one in many
    ]


def as_markdown(transfers: Sequence[Transfer]) -> str:
    """Markdown table with a row for each run.

    :param transfers: evaluations of the runs
    """
    head = " | ".join(f"{engine}: score | survival | steps/s | vibration" for engine in ENGINES)
    lines = [f"| run | task | learned in | {head} | kept |", "|---" * (4 + 4 * len(ENGINES)) + "|"]
    for one in transfers:
        cells = [
            f"{e.mean('score'):.3f} | {e.survival_rate:.2f} | {e.mean('steps_per_second'):.2f} | "
            f"{e.median('vibration'):.1f}"
            for e in one.evaluations.values()
        ]
        learned, name = one.learned, plain_text(one.learned.name)
        lines.append(
            f"| {name} | {learned.task.name} | {learned.config.engine} | {' | '.join(cells)} | {one.kept:.0%} |"
        )
    return "\n".join(lines)
