"""What is it worth to renew parameters while the robot runs?

Parameters learned in PyBullet run robots in MuJoCo that differ. No learner's settings were chosen on these robots.
"""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator
from dataclasses import dataclass
from statistics import mean
from typing import Any

import numpy as np
from matplotlib.figure import Figure
from pandas import DataFrame

from experiments.experiment import TRAINING, Experiment, product
from experiments.record import Row
from experiments.shapes import COLOURS, groups, legend, panels
from experiments.tables import shown, span, table
from sarah.episode.from_mapping import from_mapping
from sarah.operation.settings import SHIPPED, Change, OperationConfig, Parameters
from sarah.reports.uncertainty import difference
from sarah.runs.session import SessionSpec
from sarah.training.operate import SessionResult, run_session

WEAK = {"randomisation": {"actuator_bandwidth": 12.0}}
"""Servos of 12 per second, where the simulation had 40 to 50."""
ROBOTS: dict[str, dict[str, Any]] = {
    "as simulated": {},
    "weak servos": WEAK,
    "50 ms of delay, 5 kg of payload": {"payload": 5.0, "randomisation": {"delay_seconds": 0.05}},
    "slope of 6 degrees": {"terrain": {"slope_degrees": 6.0, "direction_degrees": (0.0, 360.0)}},
}
"""Settings of the robots that do not change, by name."""
CHANGING = "servos weaken at minute 5"
OTHERS = ("naf", "cma-es", "random")
LEARNERS = ("none", "careful", *OTHERS)
BEST = "best known, frozen"
SPANS = {"0_to_3": (0.0, 3.0), "3_to_5": (3.0, 5.0), "5_to_8": (5.0, 8.0), "from_8": (8.0, math.inf)}
"""Spans of the time of operation, in min."""
FIRST_SEARCH_SEED = 1000
FORMATS = {"gain": ".3f", "_min": ".3f", "parameters": ".3f", "falls_per_session": ".1f"}


@dataclass(frozen=True)
class Operation(Experiment):
    """Sessions of every learner, beside frozen parameters on the same robots."""

    depends_on = (*TRAINING, "sarah/operation")
    sessions: int = 20  # number of sessions of the careful learner, and of frozen parameters
    other_sessions: int = 10  # number of sessions of the other learners
    minutes: float = 10.0  # duration of a session, in min
    search_sessions: int = 4  # number of sessions on other seeds that look for the best known parameters of a robot
    search_minutes: float = 30.0  # duration of these, in min

    def cases(self) -> list[Row]:
        """Every robot with every learner."""
        return [*product(robot=ROBOTS, learner=(*LEARNERS, BEST)), *product(robot=[CHANGING], learner=LEARNERS)]

    def rows(self, robot: str, learner: str) -> Iterator[Row]:
        """Means over the sessions of a learner."""
        seeds = range(self.other_sessions if learner in OTHERS else self.sessions)
        config = self._config(robot, self.minutes)
        frozen = [_session(config, seed) for seed in seeds]
        found = frozen
        if learner == BEST:
            best = self._best_known(robot)
            found = [_session(config, seed, best) for seed in seeds]
        elif learner != "none":
            found = [_session(config, seed, learner=learner) for seed in seeds]
        scores, others = (np.array([[one.mean_score()] for one in sessions]) for sessions in (found, frozen))
        gain, low, high = difference(scores, others)
        yield {
            "score": float(scores.mean()),
            **{f"score_{name}_min": mean(one.mean_score(*ends) for one in found) for name, ends in SPANS.items()},
            "gain": gain,
            "gain_low": low,
            "gain_high": high,
            "falls_per_session": mean(one.falls for one in found),
            "score_of_last_parameters": None if learner == BEST else self._left(robot, found),
        }

    def _left(self, robot: str, found: list[SessionResult]) -> float:
        """Score of the parameters that sessions end with, frozen on the same robots as they are in the end."""
        in_the_end = "weak servos" if robot == CHANGING else robot
        config = self._config(in_the_end, max(0.1, self.minutes / 5.0))
        return mean(_session(config, seed, one.parameters).mean_score() for seed, one in enumerate(found))

    def _config(self, robot: str, minutes: float) -> OperationConfig:
        changes = (Change(minutes / 2.0, WEAK),) if robot == CHANGING else ()
        settings = {"engine": "mujoco", **ROBOTS.get(robot, {})}
        return OperationConfig(from_mapping(OperationConfig().robot, settings), minutes=minutes, changes=changes)

    def _best_known(self, robot: str) -> Parameters:
        """Of what long sessions on other seeds end with, the parameters that do best on these seeds."""
        seeds = range(FIRST_SEARCH_SEED, FIRST_SEARCH_SEED + self.search_sessions)
        long, short = (self._config(robot, minutes) for minutes in (self.search_minutes, min(2.0, self.search_minutes)))
        candidates = [SHIPPED, *(_session(long, seed, learner="careful").parameters for seed in seeds)]
        return max(candidates, key=lambda one: mean(_session(short, seed, one).mean_score() for seed in seeds))


def _session(
    config: OperationConfig, seed: int, parameters: Parameters = SHIPPED, learner: str = "none"
) -> SessionResult:
    """Run a session."""
    return run_session(SessionSpec(parameters, learner, seed, config))


FULL = Operation()
QUICK = Operation(sessions=1, other_sessions=1, minutes=0.1, search_sessions=1, search_minutes=0.1)


def answer(rows: DataFrame) -> str:
    """What the careful learner is worth, and what another leaves."""
    careful, evolved = rows[rows.learner == "careful"], rows[rows.learner == "cma-es"]
    weak, changing = (rows[rows.robot == robot].set_index("learner") for robot in ("weak servos", CHANGING))
    right = careful[~careful.robot.isin(["weak servos", CHANGING])]
    dearer = careful.set_index("robot").gain - evolved.set_index("robot").gain
    falls = careful.falls_per_session.max()
    fell = f"Robots fall up to {shown(falls, '.1f')} times a session." if falls else "With this learner no robot falls."
    return (
        f"Much, where the robot differs much. With weak servos frozen parameters score "
        f"{shown(weak.score['none'], '.2f')}. The careful learner reaches "
        f"{shown(weak.score_from_8_min['careful'], '.2f')} in the last two of ten minutes. If the servos weaken at "
        f"minute 5, it gets back to {shown(changing.score_from_8_min['careful'], '.2f')}. On the other robots the "
        f"shipped parameters are nearly right already, so there is little to gain: {span(right.gain, '.3f')} over the "
        f"ten minutes. {fell}\n\n"
        f"The parameters that CMA-ES ends with score {span(evolved.score_of_last_parameters, '.2f')}, and those of the "
        f"careful learner {span(careful.score_of_last_parameters, '.2f')}. But the search of CMA-ES costs more: over "
        f"the ten minutes its score is {span(dearer, '.2f')} lower, and robots fall up to "
        f"{shown(evolved.falls_per_session.max(), '.1f')} times a session."
    )


def figure(rows: DataFrame) -> Figure:
    """Score along a session, without random search."""
    drawn, axes = panels(len(ROBOTS) + 1, 0.4, sharey=True)
    for axis, (robot, group) in zip(axes, groups(rows[rows.learner != "random"], "robot").items(), strict=True):
        for colour, row in zip(COLOURS, group.to_dict("records"), strict=False):
            scores = [row[f"score_{name}_min"] for name in SPANS]
            axis.plot((1.5, 4.0, 6.5, 9.0), scores, ".-", color=colour, label=row["learner"])
        axis.set(xlabel="minute", ylabel="score")
        axis.set_title(textwrap.fill(str(robot), 16), fontsize="small")
        axis.label_outer()
    legend(drawn, axes[0])
    return drawn


def robots(rows: DataFrame) -> str:
    """What each learner is worth on robots that do not change."""
    columns = ["robot", "learner", "score", "gain", "gain_low", "gain_high", "falls_per_session", "score_from_8_min"]
    caption = (
        f"Sessions of {FULL.minutes:g} minutes in MuJoCo that begin with the shipped P1 to P5 and V1 to V4. The gain "
        f"is over frozen parameters, with its 95 % interval. The last parameters run frozen on the same robot."
    )
    return table(rows[rows.robot != CHANGING], [*columns, "score_of_last_parameters"], caption, **FORMATS)


def change(rows: DataFrame) -> str:
    """What each learner does when the servos weaken."""
    spans = [f"score_{name}_min" for name in ("3_to_5", "5_to_8", "from_8")]
    columns = ["learner", *spans, "gain", "gain_low", "gain_high", "falls_per_session", "score_of_last_parameters"]
    caption = "The servos weaken at minute 5: score before, in the three minutes after, and later."
    return table(rows[rows.robot == CHANGING], columns, caption, **FORMATS)
