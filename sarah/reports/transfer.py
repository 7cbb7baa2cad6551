"""The transfer of learned parameters from one physics engine to the others, on the same seeds and pushes."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, product
from typing import get_args

from sarah.episode.evaluation import Evaluation
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.reports.markdown import plain_text
from sarah.simulation.engines import Engine

ENGINES: tuple[Engine, ...] = get_args(Engine)


@dataclass(frozen=True)
class Transfer:
    """Evaluations of learned parameters in every engine.

    :param name: name of the run folder, or the parameters themselves
    :param learned: an episode of the learned parameters, in the engine that they were learned in
    :param evaluations: evaluations by engine
    """

    name: str
    learned: EpisodeSpec
    evaluations: dict[Engine, Evaluation]

    @property
    def kept(self) -> float:
        """Lowest score in another engine, as a share of that in the engine of the training; 0 if the latter is 0."""
        scores = {engine: evaluation.mean("score") for engine, evaluation in self.evaluations.items()}
        at_home = scores.pop(self.learned.config.engine)
        return min(scores.values()) / at_home if at_home else 0.0


def transfer(many: Sequence[tuple[str, EpisodeSpec]], seeds: Sequence[int], workers: Workers) -> list[Transfer]:
    """Evaluate learned parameters in every engine.

    :param many: names and episodes of learned parameters
    :param seeds: seeds of the episodes, the same for all
    :param workers: workers that simulate the episodes
    """
    specs = [
        dataclasses.replace(learned, seed=seed, config=dataclasses.replace(learned.config, engine=engine))
        for (_, learned), engine, seed in product(many, ENGINES, seeds)
    ]
    results = iter(list(workers.simulate_all(specs)))
    return [
        Transfer(
            name,
            learned,
            {
                engine: Evaluation(tuple(islice(results, len(seeds))), learned.config.least_clearance)
                for engine in ENGINES
            },
        )
        for name, learned in many
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
        learned, name = one.learned, plain_text(one.name)
        lines.append(
            f"| {name} | {learned.task.name} | {learned.config.engine} | {' | '.join(cells)} | {one.kept:.0%} |"
        )
    return "\n".join(lines)
