"""What have robots felt and tried that differ from the simulated one?

The rows are windows: ``sarah-train --offline results/logged_robots.csv`` learns from them. Robots that are never logged
are kept for judging what was learned.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from pandas import DataFrame

from experiments.experiment import TRAINING, Experiment
from experiments.record import Row
from experiments.tables import table
from sarah.control.parameters import Parameters
from sarah.episode.from_mapping import from_mapping
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import BOX, PARAMETERS, SHIPPED, OperationConfig
from sarah.operation.window import FELT, Window
from sarah.runs.session import SessionSpec
from sarah.simulation.engines import Engine
from sarah.training.operate import run_session


class Differing(NamedTuple):
    """A robot that differs from the simulated one: values that it does not have are the simulated ones.

    :param servos: bandwidth of the servos, per second
    :param delay: delay of the sensors, in ms
    :param load: payload, in kg
    :param slope: slope of the ground, in degrees; each seed walks it in another direction
    :param friction: friction coefficient
    """

    servos: float | None = None
    delay: float | None = None
    load: float | None = None
    slope: float | None = None
    friction: float | None = None

    def __str__(self) -> str:
        """Name: what differs, with units."""
        units = {"servos": "/s", "delay": " ms", "load": " kg", "slope": " degrees", "friction": ""}
        given = {name: value for name, value in self._asdict().items() if value is not None}
        return ", ".join(f"{name} {value:g}{units[name]}" for name, value in given.items()) or "as simulated"

    def config(self, minutes: float, engine: Engine = "mujoco") -> OperationConfig:
        """Settings of its operation."""
        settings: dict[str, Any] = {"engine": engine}
        randomisation = {}
        if self.servos is not None:
            randomisation["actuator_bandwidth"] = self.servos
        if self.delay is not None:
            randomisation["delay_seconds"] = self.delay / 1000.0
        if self.friction is not None:
            randomisation["friction"] = self.friction
        if self.load is not None:
            settings["payload"] = self.load
        if self.slope is not None:
            settings["terrain"] = {"slope_degrees": self.slope, "direction_degrees": (0.0, 360.0)}
        robot = from_mapping(OperationConfig().robot, {**settings, "randomisation": randomisation})
        return OperationConfig(robot, minutes=minutes)


LOGGED = (
    *(Differing(servos=servos) for servos in (7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0, 16.0)),
    *(Differing(delay=delay) for delay in (60.0, 70.0, 80.0, 90.0)),
    *(Differing(load=load) for load in (8.0, 15.0)),
    Differing(slope=4.0),
    Differing(),
    *(Differing(servos, delay) for servos, delay in ((10.0, 40.0), (12.0, 50.0), (13.0, 60.0))),
    *(Differing(servos, load=load) for servos, load in ((9.0, 8.0), (11.0, 12.0))),
    *(Differing(delay=delay, load=load) for delay, load in ((60.0, 8.0), (80.0, 5.0))),
    Differing(12.0, 30.0, 8.0),
)
"""Robots of the logs: dense where the shipped parameters fail."""
HELD_OUT = (
    *(Differing(servos=servos) for servos in (6.5, 8.5, 10.5)),
    *(Differing(delay=delay) for delay in (75.0, 95.0)),
    Differing(9.5, load=4.0),
    Differing(11.5, 45.0),
    Differing(delay=70.0, load=6.0),
    Differing(),
    Differing(servos=25.0),
    Differing(delay=30.0),
    Differing(load=5.0),
    Differing(slope=6.0),
)
"""Robots for judging, by a rule: half way between those of the logs, and a step beyond. They were fixed before any log
was made. ``as simulated`` is in both lists, with other seeds."""
UNKNOWN = (Differing(servos=10.0, friction=0.25), Differing(load=25.0))
"""Robots for judging of kinds that no log has, fixed before any robot for judging ran."""
FIRST_LOGGED_SEED = 2000
FIRST_HELD_OUT_SEED = 3000
REACH = 0.25
"""Largest distance of the random sets from the shipped one, as a share of each range."""
ROBOTS = {str(robot): robot for robot in LOGGED}


@dataclass(frozen=True)
class LoggedRobots(Experiment):
    """Logs of robots, each with a seed of its own."""

    depends_on = (*TRAINING, "sarah/operation")
    minutes: float = 6.0  # duration of the sessions of the careful learner and of CMA-ES, in min
    sets: int = 10  # number of random sets, which are the same on all robots
    robots: int = len(ROBOTS)  # number of robots
    windows: int = 5  # number of windows with the shipped set, and with each set that a learner leaves

    def cases(self) -> list[Row]:
        """Every robot."""
        return [{"robot": name} for name in list(ROBOTS)[: self.robots]]

    def rows(self, robot: str) -> Iterator[Row]:
        """The windows of a robot's logs."""
        seed = FIRST_LOGGED_SEED + list(ROBOTS).index(robot)
        config = ROBOTS[robot].config(self.minutes)
        random = np.random.default_rng(FIRST_LOGGED_SEED)
        shares = np.array(BOX.shares(SHIPPED)) + random.uniform(-REACH, REACH, (self.sets, len(PARAMETERS)))
        yield from window_rows("shipped", tried(config, seed, [SHIPPED] * self.windows))
        yield from window_rows(
            "random", tried(config, seed, [BOX.at_shares(np.clip(share, 0.0, 1.0)) for share in shares])
        )
        for learner in ("careful", "cma-es"):
            session = run_session(SessionSpec(SHIPPED, learner, seed, config))
            yield from window_rows(learner, session.windows)
            yield from window_rows(f"left by {learner}", tried(config, seed, [session.parameters] * self.windows))


def tried(config: OperationConfig, seed: int, sets: Sequence[Parameters]) -> list[Window]:
    """Windows of sets, one after the other."""
    robot = RobotInOperation(dataclasses.replace(config, minutes=600.0), seed)
    try:
        return [robot.run(parameters) for parameters in sets]
    finally:
        robot.close()


def window_rows(log: str, windows: Sequence[Window]) -> Iterator[Row]:
    """Rows of windows, with the columns of a session's table."""
    for window in windows:
        plain = window.plain()
        named = zip((parameter.name for parameter in PARAMETERS), plain.pop("parameters"), strict=True)
        felt = zip(FELT, plain.pop("felt"), strict=True)
        yield {"log": log, **plain, "fell": int(window.fell), **dict(named), **dict(felt)}


FULL = LoggedRobots()
QUICK = LoggedRobots(minutes=0.1, sets=1, robots=1, windows=1)


def robots(rows: DataFrame) -> str:
    """What was observed of each robot."""
    means = rows.pivot_table(index="robot", columns="log", values="observed_reward", sort=False)
    falls = rows.groupby("robot", sort=False).fell.sum()
    shown_rows = means.assign(windows=rows.groupby("robot", sort=False).size(), falls=falls).reset_index()
    columns = ["shipped", "left by careful", "left by cma-es"]
    caption = (
        f"Observed rewards on the robots of the logs, means of {FULL.windows} windows each: with the shipped "
        "parameters, and with those that the careful learner and CMA-ES leave."
    )
    return table(shown_rows, ["robot", "windows", "falls", *columns], caption, **dict.fromkeys(columns, ".2f"))
