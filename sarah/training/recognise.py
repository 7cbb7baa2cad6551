"""A robot is recognised by what it feels, gets parameters that are known for it, and learns on carefully from there."""

from __future__ import annotations

import math
from statistics import fmean

import numpy as np

from sarah.control.parameters import Parameters
from sarah.errors import ConfigurationError
from sarah.operation.operated_robot import OperatedRobot
from sarah.operation.settings import BOX, OperationConfig
from sarah.operation.window import Window
from sarah.recognition.belief import NOISE, Belief, believed, is_known, place_of, rows_of_kind
from sarah.recognition.felt import features_of
from sarah.recognition.recognition import Conditions, Recognition
from sarah.training.careful import LENGTH, CarefulSearch

GAIN = 0.02
"""Reward by which what is believed of a set, less a deviation, must beat what was observed of the best one so far."""
GOOD = 0.93
"""Observed reward from which on nothing is pushed."""
SETTLED = 3
"""Number of windows after which what was observed of a set replaces belief."""
WELL_BELOW = 0.1
"""Reward by which a window falls well below the reference."""
BANNING = 2
"""Number of such windows in a row that ban a set."""
LENGTH_AT_TOP = 0.2
"""Length over which the reward is taken to change near a set that was found by learning, as a share of each range:
shorter than elsewhere, so that trials change less."""
RECENT = 4
"""Number of the last windows of the careful learner whose mean is compared with what is believed of a set."""
LOSS = 0.1
"""Reward that windows of the careful learner must lose before the robot is recognised anew."""
LOST_WINDOWS = 2
"""Number of such windows in a row, where the reference is worth less than was expected by more than that loss;
elsewhere a single one is enough."""
PATIENCE = 10
"""Least number of windows between two recognitions where the reference costs that much."""
CHANGED = 0.5
"""Distance of a robot from its former place at which it counts as changed, over that beyond which one is unknown."""


def check_recognition(recognition: Recognition, config: OperationConfig, first: Parameters) -> None:
    """Refuse a robot that cannot be compared with those of the logs.

    :param recognition: what logs teach
    :param config: settings of the operation
    :param first: parameters to begin with
    :raises ConfigurationError: naming what differs
    """
    recognition.conditions.check(Conditions.of(config), "the robot")
    if first != recognition.reference:
        raise ConfigurationError(
            "learner recognise begins with the parameters that robots are recognised with: "
            + ",".join(f"{value:g}" for value in recognition.reference)
        )


def operate_recognised(robot: OperatedRobot, first: Parameters, seed: int, recognition: Recognition) -> Parameters:
    """Operate a robot with parameters that are known for its kind, and learn on from there, until the time is over.

    :param robot: robot to operate
    :param first: parameters to begin with: those that robots are recognised with
    :param seed: seed of the careful learner
    :param recognition: what logs teach
    :return: parameters to leave the robot with
    :raises ConfigurationError: if the robot cannot be compared with those of the logs
    """
    check_recognition(recognition, robot.config, first)
    known = _Known(recognition, robot)
    known.recognise()
    recognised = robot.windows
    while True:
        known.push()
        search, rewards, lost = known.careful(seed), [], 0
        while True:
            if robot.is_over:
                return search.choice()
            parameters = search.ask(robot.windows_left)
            window = robot.run(parameters)
            search.tell(parameters, window.observed_reward, window.fell)
            known.observe(window)
            rewards.append(window.observed_reward)
            lost = lost + 1 if search.lost > LOSS else 0
            is_due = lost >= LOST_WINDOWS and robot.windows >= recognised + PATIENCE
            is_cheap = known.reference_reward >= window.observed_reward + search.lost - LOSS
            if lost and (is_due or is_cheap) and not robot.is_over:
                recognised = robot.windows
                if known.recognise(window):
                    break
            elif not lost and known.is_better_than(rewards[-RECENT:]):
                break


class _Known:
    """What is known of a robot since it was last recognised.

    :param recognition: what logs teach
    :param robot: robot to operate
    """

    def __init__(self, recognition: Recognition, robot: OperatedRobot) -> None:
        self._recognition, self._robot = recognition, robot
        self._reference = recognition.reference
        self._observed: dict[Parameters, list[float]] = {}
        self._banned: set[Parameters] = set()
        self._place = np.zeros(len(recognition.whitening))
        self._sets = {recognition.reference, *recognition.sets}

    @property
    def reference_reward(self) -> float:
        """Mean reward that was observed of the reference."""
        return fmean(self._observed[self._reference])

    def recognise(self, last: Window | None = None) -> bool:
        """Feel the robot with the reference. If it is another one than before, nothing is known of it any longer.

        :param last: last window, which is felt if it ran the reference
        :return: whether it is another one
        """
        window, is_first = last, not self._observed
        if window is None or window.parameters != self._reference:
            window = self._run_reference()
        if window.fell and not self._robot.is_over:  # it ended too soon for the robot to be felt
            window = self._run_reference()
        place = place_of(self._recognition, features_of(window.felt, self._robot.config.robot.scale))
        if not is_first and np.linalg.norm(place - self._place) <= CHANGED * self._recognition.far:
            return False
        self._place, self._observed, self._banned = place, {self._reference: [window.observed_reward]}, set()
        return True

    def push(self) -> None:
        """Run what is believed to be better than all that was observed, until there is nothing."""
        while not self._robot.is_over and (parameters := self._better(self._present())) is not None:
            self.observe(self._robot.run(parameters))
            last = self._observed[parameters][-BANNING:]
            if len(last) == BANNING and max(last) < self.reference_reward - WELL_BELOW:
                self._banned.add(parameters)

    def observe(self, window: Window) -> None:
        """Learn what a known set was worth.

        :param window: window of the robot, with any parameters
        """
        if window.parameters in self._sets:
            self._observed.setdefault(window.parameters, []).append(window.observed_reward)

    def is_better_than(self, rewards: list[float]) -> bool:
        """Whether a set is believed to be better than what the careful learner gets, and would be pushed.

        :param rewards: its last rewards
        """
        return len(rewards) == RECENT and self._better(max(fmean(rewards), self._present())) is not None

    def careful(self, seed: int) -> CarefulSearch:
        """The careful learner from the best set, with what was observed, and what logs say of robots of this kind.

        :param seed: seed of its draws
        """
        usable = [one for one in self._observed if one not in self._banned]
        start = max(usable, key=lambda one: fmean(self._observed[one]) - NOISE / math.sqrt(len(self._observed[one])))
        known = rows_of_kind(self._recognition, self._place, self._observed) if self._is_known else []
        search = CarefulSearch(BOX, seed, start, known, LENGTH if start == self._reference else LENGTH_AT_TOP)
        for parameters in sorted(self._observed, key=lambda one: one != start):
            for reward in self._observed[parameters]:
                search.remember(parameters, reward)
        search.stay_above(self.reference_reward)
        return search

    def _run_reference(self) -> Window:
        window = self._robot.run(self._reference)
        self.observe(window)
        return window

    @property
    def _is_known(self) -> bool:
        return is_known(self._recognition, self._place)

    def _settled(self) -> list[Parameters]:
        """Sets of which what was observed has replaced belief."""
        return [one for one, rewards in self._observed.items() if len(rewards) >= SETTLED]

    def _present(self) -> float:
        """Reward of the best set so far: as it was observed, and of the reference as it is believed.

        One window may be chance. But once a set that was pushed turned out well below the reference, belief was wrong.
        """
        worst = min(fmean(rewards) for rewards in self._observed.values())
        is_believed = self._is_known and worst >= self.reference_reward - WELL_BELOW
        expected = self._beliefs()[self._reference].reward if is_believed else self.reference_reward
        return max([expected, *(fmean(self._observed[one]) for one in self._settled())])

    def _beliefs(self) -> dict[Parameters, Belief]:
        return {one.parameters: one for one in believed(self._recognition, self._place, self._observed)}

    def _better(self, present: float) -> Parameters | None:
        """The set that is believed to be best, if that is better than the present reward; else none.

        :param present: reward that is had without it
        """
        if present >= GOOD or not self._is_known:
            return None
        closed = {self._reference, *self._banned, *self._settled()}
        beliefs = [belief for parameters, belief in self._beliefs().items() if parameters not in closed]
        best = max(beliefs, key=lambda belief: belief.reward - belief.deviation, default=None)
        if best is None or best.reward - best.deviation < present + GAIN:
            return None
        return best.parameters
