"""What are logs of other robots worth to a robot?

Robots that no log has, fixed before anything was learned, run with frozen parameters, with the careful learner, and
with what the results ``logged_robots`` and ``logged_sets`` teach. From these two results ``python -m
experiments.robot.learned_from_logs`` writes the recognition that the package ships, sarah/recognition/recognition.json.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from experiments import record
from experiments.experiment import TRAINING, Experiment, product
from experiments.record import Row
from experiments.robot.logged_robots import FIRST_HELD_OUT_SEED, HELD_OUT, UNKNOWN, Differing
from sarah.files import replace_text
from sarah.operation.settings import SHIPPED, Change
from sarah.recognition.learning import best_of_all, learn
from sarah.recognition.logs import read_logs
from sarah.recognition.recognition import SHIPPED_FILE, Kind, Recognition
from sarah.runs.session import SessionSpec
from sarah.simulation.engines import Engine
from sarah.training.operate import SessionResult, run_session

LOGS = ("logged_robots", "logged_sets")
CHANGING = "servos 10/s from minute 5"
ROBOTS = {**{str(robot): robot for robot in (*HELD_OUT[::2], *HELD_OUT[1::2], *UNKNOWN)}, CHANGING: Differing()}
GROUPS = {
    **dict.fromkeys(map(str, HELD_OUT), "known"),
    **dict.fromkeys(map(str, UNKNOWN), "unknown"),
    CHANGING: "changing",
}
FROZEN, CAREFUL, BEST = "frozen", "careful", "one set for all, frozen"
RECOGNISE = {f"recognise, {kind}": kind for kind in ("nearest", "classes", "network")}
LONG = ("recognise, nearest", CAREFUL, FROZEN)
SHORT = (BEST, "recognise, classes", "recognise, network")
"""Learners of which only the first minutes are asked for."""
SPANS = {"first_minute": (0.0, 1.1), "first_3_min": (0.0, 3.1), "minute_6": (5.05, 6.12), "from_8_min": (8.0, 11.0)}
"""Spans of the time of operation, in min, by the end of the windows: the first one begins with a second of standing."""
HARD, EASY = 0.85, 0.92
"""Mean score of the frozen parameters below which a robot is hard, and from which on it is easy."""


@dataclass(frozen=True)
class LearnedFromLogs(Experiment):
    """Sessions of robots that no log has."""

    depends_on = (*TRAINING, "sarah/operation", "sarah/recognition")
    seeds: int = 5  # number of seeds of each robot and learner
    robots: int = len(ROBOTS)  # number of robots
    minutes: float = 10.0  # duration of the sessions, in min
    short_minutes: float = 3.0  # duration of those of which only the beginning is asked for, in min

    def cases(self) -> list[Row]:
        """Every robot with every learner, one seed after the other, and a seed in the other engine."""
        robots = list(ROBOTS)[: self.robots]
        every: list[Row] = []
        for seed in range(self.seeds):
            for learners in (LONG, SHORT):
                every += product(engine=["mujoco"], seed=[seed], robot=robots, learner=learners)
            if seed == 0:
                every += product(engine=["pybullet"], seed=[seed], robot=robots, learner=LONG)
        return [case for case in every if case["robot"] != CHANGING or not _is_short(**case)]

    def rows(self, engine: Engine, seed: int, robot: str, learner: str) -> Iterator[Row]:
        """Mean scores of a session."""
        is_short = _is_short(engine, seed, robot, learner)
        minutes = min(self.minutes, self.short_minutes) if is_short else self.minutes
        config = ROBOTS[robot].config(minutes, engine)
        if robot == CHANGING:
            change = Change(minutes / 2.0, {"randomisation": {"actuator_bandwidth": 10.0}})
            config = dataclasses.replace(config, changes=(change,))
        first = FIRST_HELD_OUT_SEED + 100 * list(ROBOTS).index(robot)
        name = {FROZEN: "none", BEST: "none"}.get(learner, learner.partition(",")[0])
        recognition = learned(RECOGNISE[learner]) if learner in RECOGNISE else None
        parameters = best_of_all(learned("best")) if learner == BEST else SHIPPED
        identity = recognition.identity if recognition else ""
        spec = SessionSpec(parameters, name, first + seed, config, identity)
        found = run_session(spec, recognition=recognition)
        yield {"group": GROUPS[robot], **_scores(found, is_short), "falls": found.falls}


def _is_short(engine: Engine, seed: int, robot: str, learner: str) -> bool:
    """Whether only the first minutes of a case are asked for."""
    return learner in SHORT or engine != "mujoco"


def _scores(found: SessionResult, is_short: bool) -> Row:
    spans = {
        name: None if is_short and end > 4.0 else found.mean_score(begin, end) for name, (begin, end) in SPANS.items()
    }
    return {"score": None if is_short else found.mean_score(), **spans}


@lru_cache
def learned(kind: Kind) -> Recognition:
    """What both logs teach."""
    return learn(read_logs([record.RESULTS / f"{name}.csv" for name in LOGS]), kind)


FULL = LearnedFromLogs()
QUICK = LearnedFromLogs(seeds=1, robots=1, minutes=0.1, short_minutes=0.1)


def ship(path: Path = SHIPPED_FILE) -> None:
    """Write the recognition that the package ships."""
    replace_text(path, learned("nearest").text())


if __name__ == "__main__":
    ship()
