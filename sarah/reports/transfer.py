"""What was learned in one physics engine, in the other: the same seeds and pushes in both."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import islice, product
from typing import get_args

from sarah.episode.evaluation import Evaluation, summarise
from sarah.episode.spec import EpisodeConfig, EpisodeSpec
from sarah.episode.workers import Workers
from sarah.simulation.engines import Engine

ENGINES: tuple[Engine, ...] = get_args(Engine)


@dataclass(frozen=True)
class Subject:
    """Learned parameters.

    :param name: of the run
    :param task: ``"stepping"`` or ``"balance"``
    :param parameters: P1 to P5, or V1 to V4
    :param config: settings of the episodes; its engine is the one they were learned in
    """

    name: str
    task: str
    parameters: tuple[float, ...]
    config: EpisodeConfig


@dataclass(frozen=True)
class Transfer:
    """Learned parameters in every engine.

    :param subject: what was evaluated
    :param evaluations: by engine
    """

    subject: Subject
    evaluations: dict[Engine, Evaluation]

    @property
    def kept(self) -> float:
        """Score in the other engine over that in the one they were learned in; 0 if they score nothing there."""
        at_home = self.evaluations[self.subject.config.engine].score_mean
        (abroad,) = (e.score_mean for engine, e in self.evaluations.items() if engine != self.subject.config.engine)
        return abroad / at_home if at_home else 0.0


def transfer(subjects: Sequence[Subject], seeds: Sequence[int], workers: Workers) -> list[Transfer]:
    """Evaluate parameters in every engine.

    :param subjects: what was learned
    :param seeds: of the episodes, the same for all
    :param workers: that simulate them
    """
    specs = [
        EpisodeSpec(subject.parameters, seed, subject.task, dataclasses.replace(subject.config, engine=engine))
        for subject, engine, seed in product(subjects, ENGINES, seeds)
    ]
    results = iter(list(workers.simulate_all(specs)))
    return [
        Transfer(subject, {engine: summarise(islice(results, len(seeds))) for engine in ENGINES})
        for subject in subjects
    ]


def as_markdown(transfers: Sequence[Transfer]) -> str:
    """The table: a row for each run.

    :param transfers: of the runs
    """
    head = " | ".join(f"{engine}: score | survival | steps/s | vibration" for engine in ENGINES)
    lines = [f"| run | task | learned in | {head} | kept |", "|---" * (4 + 4 * len(ENGINES)) + "|"]
    for one in transfers:
        cells = [
            f"{e.score_mean:.3f} | {e.survival_rate:.2f} | {e.steps_per_second_mean:.2f} | {e.vibration_median:.1f}"
            for e in one.evaluations.values()
        ]
        subject = one.subject
        lines.append(
            f"| {subject.name} | {subject.task} | {subject.config.engine} | {' | '.join(cells)} | {one.kept:.0%} |"
        )
    return "\n".join(lines)
