"""The records of a window: what a robot itself knows of it, and what is true of a simulated one."""

from __future__ import annotations

import dataclasses
from functools import partial

import numpy as np

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.episode.gait import GaitRecord
from sarah.episode.recording import Return
from sarah.episode.reward import RewardSettings, highest_return, reward_rate
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.operation.odometry import LegOdometry
from sarah.operation.window import FELT
from sarah.robot.reading import SensorReading, Targets, Vector


class FeltRecord:
    """Record of what a robot feels in a window, and of the reward that its own sensors give.

    In each tick call :meth:`sensed`, :meth:`decided` and, when it is over, :meth:`judge`.

    :param height: height of the torso's centre over the floor while the robot stands, in m
    :param config: settings of the robot, with those of the reward; its form is always the symmetric one
    :param settle: ticks that are not measured
    :param measure: ticks that are
    """

    def __init__(self, height: float, config: RewardSettings, settle: int, measure: int) -> None:
        self._dt = config.physics.control_dt
        self._settle, self._measure = settle, measure
        self.observed = Return(highest_return(height, measure * self._dt, config))
        """Equation 2 with the displacement that the legs tell and the height of standing."""
        self._height = height
        self._reward_rate = symmetric_reward(config)
        self._gait = GaitRecord(config.physics.control_rate, config.scale.time)
        self._odometry = LegOdometry(height, self._dt)
        self._ticks = 0
        self._from: tuple[float, float] | None = None
        self._signals, self._lags = np.zeros((measure, 8)), np.zeros((measure, 6))
        self._heard = 0
        self._phases: dict[Phase, list[int]] = {Phase.SHIFT: [], Phase.LIFT: [], Phase.LAND: []}
        self._phase_began = 0

    @property
    def is_over(self) -> bool:
        """Whether the window has all of its ticks."""
        return self._ticks >= self._settle + self._measure

    def sensed(self, reading: SensorReading, targets: Targets) -> None:
        """Record what the robot feels, and how far its joints are from their targets.

        :param reading: sensor reading of the tick
        :param targets: joint targets of the tick before, in rad and m
        """
        self._odometry.tick(reading)
        if self._ticks >= self._settle:
            left_fore, left_hind, right_fore, right_hind = reading.pressures
            loads = (left_fore + left_hind, right_fore + right_hind)
            self._signals[self._heard] = (*reading.acceleration, *reading.angular_rate, *loads)
            lags = [abs(target - joint) for target, joint in zip(targets, reading.joints, strict=True)]
            self._lags[self._heard] = lags
            self._heard += 1

    def decided(self, change: PhaseChange | None) -> None:
        """Record the end of a phase.

        :param change: end of a phase in this tick
        """
        if change is not None:
            self._gait.phase_change(self._ticks, change)
            if change.ended in self._phases and self._ticks >= self._settle:
                self._phases[change.ended].append(self._ticks - self._phase_began)
            self._phase_began = self._ticks

    def judge(self) -> float | None:
        """Add the reward at the end of a tick.

        :return: steps per second that it was given for; ``None`` while the window settles
        """
        self._ticks += 1
        if self._ticks <= self._settle:
            return None
        odometry = self._odometry
        if self._from is None:
            self._from = (odometry.x, odometry.y)
        frequency, (from_x, from_y) = self._gait.steps_per_second(self._ticks), self._from
        rate = self._reward_rate(odometry.x - from_x, odometry.y - from_y, self._height, frequency)
        self.observed.value += rate * self._dt
        return frequency

    def felt(self) -> tuple[float, ...]:
        """What the robot felt, in the order of :data:`~sarah.operation.window.FELT`.

        A phase that never ended lasted as long as the window.
        """
        if not self._heard:
            return (0.0,) * len(FELT)
        signals = self._signals[: self._heard]
        lags = self._lags[: self._heard].mean(axis=0).reshape(3, 2).mean(axis=1)
        seconds = [self._dt * (sum(ticks) / len(ticks) if ticks else self._measure) for ticks in self._phases.values()]
        values = (
            *signals[:, :6].mean(axis=0),
            *signals[:, :6].std(axis=0),
            *seconds,
            *lags,
            *signals[:, 6:].mean(axis=0),
            self._gait.steps_per_second(self._ticks),
        )
        return tuple(round(float(value), 12) for value in values)


class TrueRecord:
    """Record of the reward that the torso's true motion since the measurement began gives.

    :param height: height of the torso's centre over the floor while the robot stands, in m
    :param config: settings of the robot, with those of the reward; its form is always the symmetric one
    :param measure: ticks that are measured
    """

    def __init__(self, height: float, config: RewardSettings, measure: int) -> None:
        self._dt = config.physics.control_dt
        self.returned = Return(highest_return(height, measure * self._dt, config))
        """Equation 2 by that motion."""
        self._reward_rate = symmetric_reward(config)
        self._first: Vector | None = None

    def judge(self, position: Vector, steps_per_second: float) -> None:
        """Add the reward at the end of a tick that is measured.

        :param position: true position of the torso's centre, in m
        :param steps_per_second: steps per second that the robot itself knows of
        """
        if self._first is None:
            self._first = position
        (x, y, z), (first_x, first_y, _) = position, self._first
        self.returned.value += self._reward_rate(x - first_x, y - first_y, z, steps_per_second) * self._dt


class WindowRecord(Observer):
    """Observer of one window of a simulated robot: both records.

    :param robot: robot that runs
    :param config: settings of the robot, with those of the reward
    :param settle: ticks that are not measured
    :param measure: ticks that are
    """

    def __init__(self, robot: RunningRobot, config: RewardSettings, settle: int, measure: int) -> None:
        height = robot.description.standing_height
        self.own = FeltRecord(height, config, settle, measure)
        """What the robot itself knows."""
        self.true = TrueRecord(height, config, measure)
        """What is true."""

    def sensed(self, robot: RunningRobot) -> None:
        """Record what the robot feels."""
        self.own.sensed(robot.last_reading, robot.generator.targets)

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        """Record the end of a phase."""
        self.own.decided(change)

    def judge(self, position: Vector) -> None:
        """Add the reward at the end of a tick, once it is measured.

        :param position: true position of the torso's centre, in m
        """
        frequency = self.own.judge()
        if frequency is not None:
            self.true.judge(position, frequency)


def symmetric_reward(config: RewardSettings) -> partial[float]:
    """Function that gives equation 2 in its symmetric form, of displacements, height and steps per second.

    :param config: settings of the reward
    """
    return partial(reward_rate, config=dataclasses.replace(config, reward_form="symmetric"))
