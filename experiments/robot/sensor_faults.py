"""What becomes of the robot when its sensors or its control loop fail, with and without a supervisor?

Each robot has the shipped parameters and steps for two seconds and more before the fault begins, so faults meet it in
any phase. It has survived if it is on its feet and in its place ten seconds later. Both robots of a pair are the same.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from statistics import median
from typing import NamedTuple

import tyro
from pandas import DataFrame

from experiments.experiment import EPISODE, Experiment, product, survival_of
from experiments.record import Row
from experiments.tables import format_of, table
from sarah.control.pattern_generator import STAND_SECONDS
from sarah.control.supervisor import State, Supervisor
from sarah.drivers.faults import FAULTS
from sarah.drivers.loop import LoopTick
from sarah.drivers.simulated_robot import FaultPlan, simulated_loop
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import NO_PUSH
from sarah.episode.tasks import BALANCE
from sarah.simulation.engines import Engine

SHIPPED = PARAMETER_SETS["balance"].spec
BEGIN, LATER = 2.0, 0.03
"""Time of stepping before the fault begins, and how much later it does with each further seed, in s."""
WITHOUT, WITH = "without", "with"
"""Names of robots without and with a supervisor."""
ENGINES = {"pybullet": "PyBullet", "mujoco": "MuJoCo"}


class Outcome(NamedTuple):
    """What became of a robot after a fault."""

    survived: bool  # whether it was on its feet and in its place
    steps_per_second: float
    stopped_after: float | None  # s from the fault until the supervisor stopped it; None if it did not


@dataclass(frozen=True)
class SensorFaults(Experiment):
    """Faults of sensors and of the control loop, without a push."""

    depends_on = (*EPISODE, "sarah/drivers")
    seeds: int = 20  # number of robots
    seconds: float = 10.0  # time after the fault, in s
    faults: tyro.conf.Suppress[tuple[str, ...]] = tuple(FAULTS)  # which

    def cases(self) -> list[Row]:
        """Each fault, engine and kind of robot."""
        return product(fault=self.faults, engine=ENGINES, supervisor=(WITHOUT, WITH))

    def rows(self, fault: str, engine: Engine, supervisor: str) -> Iterator[Row]:
        """Survival, steps per second from the fault on, and how many robots the supervisor stopped, and when."""
        outcomes = [self._outcome(fault, engine, supervisor == WITH, seed) for seed in range(self.seeds)]
        stopped = [one.stopped_after for one in outcomes if one.stopped_after is not None]
        yield {
            **survival_of(sum(one.survived for one in outcomes), self.seeds),
            "steps_per_second": sum(one.steps_per_second for one in outcomes) / self.seeds,
            "stopped": len(stopped),
            "stopped_after_s": median(stopped) if stopped else "",
        }

    def _outcome(self, fault: str, engine: Engine, is_supervised: bool, seed: int) -> Outcome:
        plan = FaultPlan(FAULTS[fault], BEGIN + LATER * seed)
        usual = BALANCE.config_of(SHIPPED.config, engine=engine, push=NO_PUSH)
        config = replace(
            usual,
            time_limit=STAND_SECONDS + plan.begin + self.seconds,
            supervisor=replace(usual.supervisor, enabled=is_supervised),
        )
        after: list[LoopTick] = []
        stops: list[float] = []

        def observe(tick: LoopTick) -> None:
            since = tick.seconds - STAND_SECONDS - plan.begin
            if since >= 0.0 and tick.change is not None and tick.change.is_step:
                after.append(tick)
            controller = tick.controller
            if isinstance(controller, Supervisor) and controller.state in (State.STOPPING, State.FALLEN):
                stops.append(since)

        robot, loop = simulated_loop(replace(SHIPPED, seed=seed, config=config), plan, observers=[observe])
        loop.run()
        robot.close()
        seconds = robot.seconds - STAND_SECONDS - plan.begin
        return Outcome(robot.ended == "time_limit", len(after) / max(seconds, 1.0), stops[0] if stops else None)


FULL = SensorFaults()
QUICK = SensorFaults(seeds=1, seconds=1.0, faults=("none", "rate about y: stuck"))


def faults(rows: DataFrame) -> str:
    """What becomes of the robot, with and without a supervisor."""
    wide = rows.pivot(index="fault", columns=["engine", "supervisor"], values=["survival", "steps_per_second"])
    wide = wide.reindex(index=list(FAULTS))
    columns = {
        (column, engine, supervisor): f"{words}, {name}, {supervisor}"
        for column, words in (("survival", "survival"), ("steps_per_second", "steps per second"))
        for engine, name in ENGINES.items()
        for supervisor in (WITHOUT, WITH)
    }
    wide = wide[list(columns)]
    wide.columns = list(columns.values())
    caption = (
        f"Survival of {FULL.seeds} robots with the shipped parameters, and their steps per second from the fault on, "
        f"without and with a supervisor. There are no pushes."
    )
    formats = {name: format_of(column) for (column, _, _), name in columns.items()}
    return table(wide.reset_index(), ["fault", *formats], caption, **formats)


def stops(rows: DataFrame) -> str:
    """How many robots the supervisor stops, and how long that takes."""
    supervised = rows[(rows["supervisor"] == WITH) & (rows["stopped"] > 0)]
    wide = supervised.pivot(index="fault", columns="engine", values=["stopped", "stopped_after_s"])
    wide = wide.reindex(index=[fault for fault in FAULTS if fault in wide.index])[
        [(column, engine) for engine in ENGINES for column in ("stopped", "stopped_after_s")]
    ]
    names = [f"{words}, {name}" for name in ENGINES.values() for words in ("stopped", "median time, s")]
    wide.columns = names
    caption = f"How many of {FULL.seeds} robots the supervisor stops, and the median time from the fault until it does."
    formats = {name: ".0f" if name.startswith("stopped") else ".2f" for name in names}
    return table(wide.reset_index(), ["fault", *names], caption, **formats)
