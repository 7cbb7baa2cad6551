"""Whether the hip law goes with what First Trainings learn: V1 on several P1 to P5.

The pattern generator is told of the abduction: nothing, how far it makes the legs lean (9.81 m/s^2 of tilt per radian,
and its rate), or what the package tells it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from experiments.maker import ParallelExperiment
from experiments.record import Row
from sarah.control.constants import ControllerConstants
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.evaluation import evaluate
from sarah.episode.push import Push
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.episode.workers import Workers
from sarah.robot.reading import GRAVITY
from sarah.simulation.engines import Engine
from sarah.simulation.randomisation import Randomisation

STEPPING = (
    PAPER_STEPPING,
    TRAINED_STEPPING,
    (0.02, 0.23, 0.29, 0.07, 1.96),
    (0.01, 0.87, 0.14, 1.97, 1.88),
    (0.43, 0.53, 0.43, 1.85, 1.68),
    (0.05, 0.94, 0.24, 1.41, 0.38),
    (0.42, 0.32, 0.31, 0.83, 0.54),
    (0.42, 0.19, 0.75, 1.17, 1.73),
    (0.04, 0.04, 0.93, 1.20, 1.22),
    (0.09, 1.22, 0.09, 0.81, 1.26),
    (0.01, 1.08, 0.09, 1.60, 0.47),
    (0.03, 0.26, 0.37, 0.17, 1.37),
)
"""P1 to P5: the paper's, the package's, and what ten First Trainings learned."""
TOLD = {
    "nothing": ControllerConstants(abduction_tilt=0.0, abduction_rate_share=0.0),
    "the legs' lean": ControllerConstants(abduction_tilt=GRAVITY, abduction_rate_share=1.0),
    "the package": ControllerConstants(),
}
"""What the pattern generator is told of the abduction."""


@dataclass(frozen=True)
class SteppingAndHips(ParallelExperiment):
    """V1 under pushes, on the P1 to P5 of the paper, of the package and of ten trainings.

    :param v1: values of V1 beside 0
    :param pushes: number of pushes
    :param newtons: range of their force, in N
    :param time_limit: time limit of an episode, in s
    :param engine: physics engine
    :param calm: leave out pushes and randomisation: all episodes of a set are then the same
    """

    v1: tuple[float, ...] = (0.7, 1.1)
    pushes: int = 8
    newtons: tuple[float, float] = (75.0, 125.0)
    time_limit: float = 10.0
    engine: Engine = "pybullet"
    calm: bool = False

    def rows(self) -> Iterator[Row]:
        """A row for each P1 to P5, what is told, and V1."""
        cases = [("nothing", 0.0), *((told, v1) for told in TOLD for v1 in self.v1)]
        with Workers(self.workers) as workers:
            for stepping in STEPPING:
                for told, v1 in cases:
                    config = BalanceConfig(
                        engine=self.engine,
                        randomisation=Randomisation(enabled=not self.calm),
                        controller=TOLD[told],
                        stepping=stepping,
                        push=Push(newtons=(0.0, 0.0) if self.calm else self.newtons),
                        time_limit=self.time_limit,
                    )
                    found = evaluate(BALANCE.name, (v1, 0.0, 0.0, 0.0), config, range(self.pushes), workers)
                    yield {
                        **{f"P{index + 1}": f"{value:.2f}" for index, value in enumerate(stepping)},
                        "told": told,
                        "V1": f"{v1:g}",
                        "score": found.mean("score"),
                        "survival": found.survival_rate,
                        "steps_per_second": found.mean("steps_per_second"),
                    }
