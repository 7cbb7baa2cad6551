"""What are logs of other robots worth to a robot?

Robots that no log has run with frozen parameters, with the careful learner, and
with what the results ``logged_robots`` and ``logged_sets`` teach. From these two results ``python -m
experiments.robot.learned_from_logs`` writes the recognition that the package ships, sarah/recognition/recognition.json.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from pandas import DataFrame

from experiments import record
from experiments.experiment import TRAINING, Experiment, product
from experiments.record import Row
from experiments.robot.faulty_robots import FaultyRobot
from experiments.robot.logged_robots import FIRST_HELD_OUT_SEED, HELD_OUT, UNKNOWN, Differing
from experiments.robot.logged_sets import MINUTES, WINDOW_SECONDS
from experiments.robot.recognised import (
    BEST,
    CAREFUL,
    CHANGING,
    EASY,
    FROZEN,
    GRADES,
    HARD,
    KNOWN_KIND,
    NEAREST,
    OTHER_KIND,
    Compared,
    compared,
    graded,
    late,
    verdicts,
)
from experiments.robot.recognised import goals as all_goals
from experiments.tables import NOTHING, shown, table, turned_table
from sarah.files import replace_text
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import SHIPPED, Change
from sarah.recognition.learning import best_of_all, learn
from sarah.recognition.logs import read_logs
from sarah.recognition.recognition import SHIPPED_FILE, Kind, Recognition
from sarah.runs.session import SessionSpec
from sarah.simulation.engines import Engine
from sarah.training.operate import SessionResult, run_session

LOGS = ("logged_robots", "logged_sets")
WEAKENING = "servos 10/s from minute 5"
FAULTY = "a dead pad, and a gyroscope that is off"
ROBOTS = {
    **{str(robot): robot for robot in (*HELD_OUT[::2], *HELD_OUT[1::2], *UNKNOWN)},
    WEAKENING: Differing(),
    FAULTY: Differing(),
}
"""Robots by name. The place of each decides its seeds."""
GROUPS = {
    **dict.fromkeys(map(str, HELD_OUT), KNOWN_KIND),
    **dict.fromkeys((*map(str, UNKNOWN), FAULTY), OTHER_KIND),
    WEAKENING: CHANGING,
}
RECOGNISE = {f"recognise, {kind}": kind for kind in ("nearest", "classes", "network")}
LONG = (NEAREST, CAREFUL, FROZEN)
SHORT = (BEST, "recognise, classes", "recognise, network")
"""Learners of which only the first minutes are asked for."""
FORMATS = {"minute": ".2f", "_min": ".3f", "minute_6": ".2f", "falls": ".1f"}
SPANS = {"first_minute": (0.0, 1.1), "first_3_min": (0.0, 3.1), "minute_6": (5.05, 6.12), "from_8_min": (8.0, 11.0)}
"""Spans of the time of operation, in min, by the end of the windows: the first one begins with a second of standing."""


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
            every += product(engine=["mujoco"], seed=[seed], robot=robots, learner=(*LONG, BEST))
            if seed == 0:
                every += product(engine=["pybullet"], seed=[seed], robot=robots, learner=LONG)
        every += product(engine=["mujoco"], seed=range(self.seeds), robot=robots, learner=SHORT[1:])
        return [case for case in every if case["robot"] != WEAKENING or not _is_short(**case)]

    def rows(self, engine: Engine, seed: int, robot: str, learner: str) -> Iterator[Row]:
        """Mean scores of a session."""
        is_short = _is_short(engine, seed, robot, learner)
        minutes = min(self.minutes, self.short_minutes) if is_short else self.minutes
        config = ROBOTS[robot].config(minutes, engine)
        if robot == WEAKENING:
            change = Change(minutes / 2.0, {"randomisation": {"actuator_bandwidth": 10.0}})
            config = dataclasses.replace(config, changes=(change,))
        first = FIRST_HELD_OUT_SEED + 100 * list(ROBOTS).index(robot)
        name = {FROZEN: "none", BEST: "none"}.get(learner, learner.partition(",")[0])
        recognition = learned(RECOGNISE[learner]) if learner in RECOGNISE else None
        parameters = best_of_all(learned("best")) if learner == BEST else SHIPPED
        identity = recognition.identity if recognition else ""
        spec = SessionSpec(parameters, name, first + seed, config, identity)
        make_robot = FaultyRobot if robot == FAULTY else RobotInOperation
        found = run_session(spec, make_robot=make_robot, recognition=recognition)
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


def answer(rows: DataFrame) -> str:
    """What logs are worth on hard robots and on easy ones, as far as rows tell."""
    rows = graded(rows)
    hard, easy = (rows[rows.grade == grade] for grade in ("hard", "easy"))
    minute = compared(hard, "first_minute")
    sentences = [
        f"On {hard.robot.nunique()} robots where the shipped parameters score below {HARD}, a robot that is recognised "
        f"scores {shown(minute.mean, '.2f')} in its first minute, in {minute.sessions} sessions. That is "
        f"{_more(compared(hard, 'first_minute', other=CAREFUL))} than the careful learner scores from scratch. In the "
        f"first three minutes it scores {_more(compared(hard, 'first_3_min', other=BEST))} than the one set that is "
        f"best for all robots of the logs, run from the first window on; its first window alone, with the shipped "
        f"parameters, costs {shown(_first_window(hard), '.3f')}. In minutes 8 to 10, on all robots that do not change, "
        f"it scores {_more(late(rows[rows.group != CHANGING]))} than the careful learner.",
    ]
    if len(easy):
        sentences.append(
            f"On {easy.robot.nunique()} robots where the shipped parameters score {EASY} or more, it scores "
            f"{_more(compared(easy, 'score', other=FROZEN))} over ten minutes than they do without learning."
        )
    return " ".join(sentences)


def _first_window(rows: DataFrame) -> float:
    """What the first window costs in the first three minutes against one set for all."""
    return compared(rows, "first_3_min", BEST, FROZEN).mean * WINDOW_SECONDS / (60.0 * MINUTES)


def _more(found: Compared) -> str:
    """A difference in words, with its interval."""
    mean, low, high = (shown(abs(one) if one is found.mean else one, ".3f") for one in found[:3])
    interval = "" if NOTHING in (low, high) else f" ({shown(found.low, '+.3f')} to {shown(found.high, '+.3f')})"
    return f"{mean} {'less' if found.mean < 0.0 else 'more'}{interval}"


def goals(rows: DataFrame) -> str:
    """The goals, and what came out."""
    found = DataFrame(
        [
            {"goal": one.goal, "at least": one.at_least, **one.found._asdict(), "reached": one.reached}
            for one in all_goals(rows)
        ]
    )
    caption = (
        "Goals, and what came out: mean scores and differences of the recogniser, with 95 % intervals over robots, or "
        "over the sessions of a single robot. The mean decides, except where a row names the upper end."
    )
    columns = ["goal", "at least", "mean", "low", "high", "sessions", "reached"]
    return table(found, columns, caption, **dict.fromkeys(columns[1:5], ".3f"))


def choices(rows: DataFrame) -> str:
    """What each way of recognising is worth against one set for all."""
    rows = graded(rows)
    found = [
        {"robots": grade, "learner": learner, "other": other, **compared(its, "first_3_min", learner, other)._asdict()}
        for grade, its in ((grade, rows[rows.grade == grade]) for grade in GRADES)
        for learner, other in (*((name, BEST) for name in RECOGNISE), (SHORT[2], SHORT[1]))
    ]
    caption = (
        "Differences in the score of the first three minutes from another learner, with 95 % intervals over robots, or "
        "over the sessions of a single robot, as between hard and easy."
    )
    columns = ["robots", "learner", "other", "mean", "low", "high", "sessions"]
    return table(DataFrame(found), columns, caption, mean="+.3f", low="+.3f", high="+.3f")


def against_one_set(rows: DataFrame) -> str:
    """Where the recogniser is ahead of one set for all, where behind, and where the interval does not tell."""
    rows = graded(rows)
    names = ("hard robots", "robots between hard and easy", "easy robots", "robots of other kinds")
    groups = {name: rows[rows.grade == grade] for name, grade in zip(names, GRADES, strict=True)}
    others = {str(robot): its for robot, its in groups[names[-1]].groupby("robot", sort=False)}
    sentences = [f"Against one set for all the recogniser is {verdicts(groups)}."]
    if others:
        sentences.append(f"Of the {len(others)} robots of other kinds, one by one, it is {verdicts(others)}.")
    return " ".join(sentences)


def learners(rows: DataFrame) -> str:
    """Mean scores of every learner by the grade of the robots."""
    rows = graded(rows)
    columns = ["first_minute", "first_3_min", "from_8_min", "score", "falls"]
    means = rows.groupby(["grade", "learner"], sort=False)[columns].mean()
    means = means.assign(sessions=rows.groupby(["grade", "learner"], sort=False).size()).reset_index()
    order = {grade: number for number, grade in enumerate(GRADES)}
    means = means[means.grade.isin(order)].sort_values("grade", key=lambda grades: grades.map(order), kind="stable")
    caption = (
        f"Mean scores of robots that no log has, in MuJoCo. On hard robots frozen shipped parameters score below "
        f"{HARD}, on easy ones {EASY} or more; no log has anything like the other kinds. Sessions with a dash "
        f"({NOTHING}) lasted three minutes only."
    )
    return table(means, ["grade", "learner", "sessions", *columns], caption, **FORMATS)


def robots(rows: DataFrame) -> str:
    """The first three minutes of every robot."""
    rows = graded(rows)
    rows = rows[rows.group != CHANGING]
    means = rows.groupby(["robot", "learner"], sort=False).first_3_min.mean().reset_index()
    caption = "Mean score of the first three minutes on each robot, in MuJoCo."
    return turned_table(means, ["robot"], "learner", "first_3_min", caption, ".2f")


def nothing_gained(rows: DataFrame) -> str:
    """What makes no difference: the ground, robots that the shipped parameters suit, and the kind of classifier."""
    rows = graded(rows)
    hard, easy = (rows[rows.grade == grade] for grade in ("hard", "easy"))
    slope = rows[rows.robot.str.startswith("slope")]
    classes, network = SHORT[1:]
    return (
        f"On a slope the recogniser scores {_more(compared(slope, 'score', other=FROZEN))} than frozen parameters over "
        f"ten minutes, and {_more(compared(slope, 'score', other=CAREFUL))} than the careful learner. "
        f"On easy robots together it scores {_more(compared(easy, 'score', other=CAREFUL))} than the careful learner. "
        f"A network instead of the linear "
        f"discriminant scores {_more(compared(hard, 'first_3_min', network, classes))} in the first three minutes on "
        f"hard robots, and the discriminant {_more(compared(hard, 'first_3_min', classes, NEAREST))} than distances do."
    )


def last_minutes(rows: DataFrame) -> str:
    """Minutes 8 to 10 of every robot, against the careful learner."""
    rows = graded(rows)
    rows = rows[rows.group != CHANGING]
    found = [
        {"robot": robot, "score": compared(its, "from_8_min").mean, **late(its)._asdict()}
        for robot, its in rows.groupby("robot", sort=False)
    ]
    caption = (
        "Minutes 8 to 10 on each robot, in MuJoCo: mean score of the recogniser, and its difference from the careful "
        "learner with the 95 % interval over seeds."
    )
    columns = ["robot", "score", "mean", "low", "high", "sessions"]
    return table(DataFrame(found), columns, caption, mean="+.3f", low="+.3f", high="+.3f")


def change(rows: DataFrame) -> str:
    """The minute after the servos weaken."""
    rows = rows[rows.group == CHANGING]
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
    caption = (
        f"Means over {rows.robot.nunique()} robots in PyBullet; all logs are of MuJoCo's. Each robot ran a single "
        "session, so there are no intervals."
    )
    return table(means, [str(column) for column in means.columns], caption, **FORMATS)


def ship(path: Path = SHIPPED_FILE) -> None:
    """Write the recognition that the package ships."""
    replace_text(path, learned("nearest").text())


if __name__ == "__main__":
    ship()
