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

import numpy as np
from pandas import DataFrame

from experiments import record
from experiments.experiment import TRAINING, Experiment, product
from experiments.record import Row
from experiments.robot.logged_robots import FIRST_HELD_OUT_SEED, HELD_OUT, UNKNOWN, Differing
from experiments.tables import NOTHING, shown, table, turned_table
from sarah.files import replace_text
from sarah.operation.settings import SHIPPED, Change
from sarah.recognition.learning import best_of_all, learn
from sarah.recognition.logs import read_logs
from sarah.recognition.recognition import SHIPPED_FILE, Kind, Recognition
from sarah.reports.uncertainty import difference
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
FORMATS = {"minute": ".2f", "_min": ".3f", "minute_6": ".2f", "falls": ".1f"}
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
            for learners in ((*LONG, BEST), SHORT[1:]):
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


NEAREST = LONG[0]


def graded(rows: DataFrame) -> DataFrame:
    """Rows of robots in MuJoCo, with a column that says how good the frozen shipped parameters are on each."""
    rows = rows[rows.engine == "mujoco"]
    frozen = rows[rows.learner == FROZEN].groupby("robot").score.mean()
    names = {
        robot: "hard" if score < HARD else "easy" if score >= EASY else "between" for robot, score in frozen.items()
    }
    rows = rows[rows.robot.isin(names)]
    return rows.assign(grade=rows.group.mask(rows.group == "known", rows.robot.map(names)))


def _grade(score: float) -> str:
    return "hard" if score < HARD else "easy" if score >= EASY else "between"


def against(rows: DataFrame, learner: str, other: str, column: str) -> tuple[float, float, float, float, int]:
    """Mean of a learner, its difference from another one with the 95 % interval, and the number of sessions."""
    wide = rows.pivot(index=["robot", "seed"], columns="learner", values=column)
    if learner not in wide or other not in wide:
        return (np.nan,) * 4 + (0,)
    both = wide[[learner, other]].dropna().to_numpy()
    if not len(both):
        return (np.nan,) * 4 + (0,)
    return (float(both[:, 0].mean()), *difference(both[:, :1], both[:, 1:]), len(both))


def answer(rows: DataFrame) -> str:
    """What logs are worth on hard robots and on easy ones, as far as rows tell."""
    rows = graded(rows)
    hard, easy = (rows[rows.grade == grade] for grade in ("hard", "easy"))
    minute, *gain, count = against(hard, NEAREST, CAREFUL, "first_minute")
    sentences = [
        f"On {hard.robot.nunique()} robots where the shipped parameters score below {HARD}, a robot that is recognised "
        f"scores {shown(minute, '.2f')} in its first minute, in {count} sessions. The difference from the careful "
        f"learner from scratch is {_with_interval(gain)}.",
    ]
    means = hard.groupby("learner").first_3_min.mean()
    scores = [f"{shown(means[name], '.2f')} ({name})" for name in (NEAREST, CAREFUL, FROZEN, BEST) if name in means]
    sentences.append(f"In the first three minutes the scores are {', '.join(scores)}.")
    _, *late, count = against(rows[rows.group == "known"], NEAREST, CAREFUL, "from_8_min")
    sentences.append(f"In minutes 8 to 10 it differs from the careful learner by {_with_interval(late)}.")
    if len(easy):
        _, *lost, count = against(easy, NEAREST, FROZEN, "score")
        sentences.append(
            f"Where the shipped parameters score {EASY} or more, it differs from frozen ones over ten minutes by "
            f"{_with_interval(lost)}, in {count} sessions."
        )
    return " ".join(sentences)


def _with_interval(found: list[float]) -> str:
    mean, *ends = (shown(value, "+.3f") for value in found)
    return mean if NOTHING in ends else f"{mean} ({' to '.join(ends)})"


def learners(rows: DataFrame) -> str:
    """Mean scores of every learner by the grade of the robots."""
    rows = graded(rows)
    columns = ["first_minute", "first_3_min", "from_8_min", "score", "falls"]
    means = rows.groupby(["grade", "learner"], sort=False)[columns].mean()
    means = means.assign(sessions=rows.groupby(["grade", "learner"], sort=False).size()).reset_index()
    order = {grade: number for number, grade in enumerate(("hard", "between", "easy", "unknown"))}
    means = means[means.grade.isin(order)].sort_values("grade", key=lambda grades: grades.map(order), kind="stable")
    caption = (
        f"Mean scores of robots that no log has, in MuJoCo. On hard robots frozen shipped parameters score below "
        f"{HARD}, on easy ones {EASY} or more; unknown are kinds of robots that no log has anything like."
    )
    return table(means, ["grade", "learner", "sessions", *columns], caption, **FORMATS)


def robots(rows: DataFrame) -> str:
    """The first three minutes of every robot."""
    rows = graded(rows)
    rows = rows[rows.group != "changing"]
    means = rows.groupby(["robot", "learner"], sort=False).first_3_min.mean().reset_index()
    caption = "Mean score of the first three minutes on each robot, in MuJoCo."
    return turned_table(means, ["robot"], "learner", "first_3_min", caption, ".2f")


def change(rows: DataFrame) -> str:
    """The minute after the servos weaken."""
    rows = rows[rows.robot == CHANGING]
    if rows.empty:
        return "That robot has not run yet."
    means = rows.groupby("learner", sort=False)[["minute_6", "from_8_min", "falls"]].mean().reset_index()
    caption = "Servos that weaken to 10 per second at minute 5: mean score in the next minute, and in the last ones."
    return table(means, ["learner", "minute_6", "from_8_min", "falls"], caption, **FORMATS)


def engines(rows: DataFrame) -> str:
    """The same robots in the engine that no log is from."""
    rows = rows[rows.engine == "pybullet"]
    if rows.empty:
        return "PyBullet's robots have not run yet."
    means = rows.groupby("learner", sort=False)[["first_minute", "first_3_min", "falls"]].mean().reset_index()
    caption = f"Means over {rows.robot.nunique()} robots in PyBullet, a session of each; all logs are of MuJoCo's."
    return table(means, [str(column) for column in means.columns], caption, **FORMATS)


def ship(path: Path = SHIPPED_FILE) -> None:
    """Write the recognition that the package ships."""
    replace_text(path, learned("nearest").text())


if __name__ == "__main__":
    ship()
