"""A window of an operation: what it was worth, and what the robot felt."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from sarah.control.pattern_generator import Phase, PhaseChange
from sarah.episode.gait import GaitRecord
from sarah.episode.recording import Return
from sarah.episode.reward import RewardSettings, highest_return, reward_rate
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.operation.odometry import LegOdometry
from sarah.operation.settings import Parameters
from sarah.robot.reading import GRAVITY, Vector
from sarah.robot.scale import Scale
from sarah.simulation.simulator import TorsoState

FELT = (
    *(f"{signal}_{what}" for what in ("mean", "deviation") for signal in ("a_x", "a_y", "a_z", "w_x", "w_y", "w_z")),
    *(f"{phase}_seconds" for phase in ("shift", "lift", "land")),
    *(f"{joint}_lag" for joint in ("abduction", "flexion", "length")),
    "left_load",
    "right_load",
    "steps_per_second",
)
"""Names of what the robot felt in a window, in order: means and deviations of the six inertial signals, mean durations
of the phases, mean distances of the joints from their targets, mean loads of the feet, and steps per second."""
_INERTIAL = (*((GRAVITY, "m/s^2"),) * 3, *((1.0, "rad/s"),) * 3)
_LAGS = ((0.1, "rad"), (0.1, "rad"), (0.01, "m"))
FELT_SIZES = (*_INERTIAL, *_INERTIAL, *((0.5, "s"),) * 3, *_LAGS, *((150.0, "N"),) * 2, (3.0, "1/s"))
"""Value of each that makes it of order 1, and its unit. It goes with the robot's size."""
LARGEST = 5.0
"""Bound to which a scaled value is clipped."""


@dataclass(frozen=True)
class Window:
    """A window of an operation.

    :param index: number of the window, from 0
    :param begin: time of operation at which it began, in s
    :param seconds: time that it took, in s, with standing before it and putting up after it
    :param changes: number of changes that had been made to robot and world
    :param parameters: P1 to P5 and V1 to V4
    :param score: equation 2 over its ceiling, by the torso's true motion since the measurement began; 1 is the best
    :param observed_reward: the same, as far as the robot's own sensors tell
    :param fell: whether the robot fell, which ended the window
    :param felt: what the robot felt, in the order of :data:`FELT`
    """

    index: int
    begin: float
    seconds: float
    changes: int
    parameters: Parameters
    score: float
    observed_reward: float
    fell: bool
    felt: tuple[float, ...]

    @property
    def end(self) -> float:
        """Time of operation at which the next one begins, in s."""
        return round(self.begin + self.seconds, 9)

    def plain(self) -> dict[str, Any]:
        """Values by name, for JSON."""
        return dataclasses.asdict(self)

    @classmethod
    def of_plain(cls, plain: dict[str, Any]) -> Window:
        """Make a window of its values.

        :param plain: values by name, as JSON gives them
        :raises TypeError: if they are not those of a window
        """
        window = cls(**plain)
        return dataclasses.replace(window, parameters=tuple(window.parameters), felt=tuple(window.felt))


class WindowRecord(Observer):
    """Observer of one window: what the robot feels, and what it is worth.

    :param robot: robot that runs
    :param config: settings of the robot, with those of the reward; its form is always the symmetric one
    :param settle: ticks that are not measured
    :param measure: ticks that are
    """

    def __init__(self, robot: RunningRobot, config: RewardSettings, settle: int, measure: int) -> None:
        height = robot.description.standing_height
        self._dt = config.physics.control_dt
        self._settle, self._measure = settle, measure
        ceiling = highest_return(height, measure * self._dt, config)
        self.true, self.observed = Return(ceiling), Return(ceiling)
        """Equation 2 by the torso's motion since the measurement began, and with the displacement that the legs tell
        and the height of standing."""
        self._height = height
        self._reward_rate = partial(reward_rate, config=dataclasses.replace(config, reward_form="symmetric"))
        self._gait = GaitRecord(config.physics.control_rate, config.scale.time)
        self._odometry = LegOdometry(height, self._dt)
        self._ticks = 0
        self._first: TorsoState | None = None
        self._from = (0.0, 0.0)
        self._readings: list[tuple[float, ...]] = []
        self._lags: list[list[float]] = []
        self._phases: dict[Phase, list[int]] = {Phase.SHIFT: [], Phase.LIFT: [], Phase.LAND: []}
        self._phase_began = 0

    def sensed(self, robot: RunningRobot) -> None:
        """Record what the robot feels, and how far its joints are from their targets."""
        reading = robot.last_reading
        self._odometry.tick(reading)
        if self._ticks >= self._settle:
            left_fore, left_hind, right_fore, right_hind = reading.pressures
            loads = (left_fore + left_hind, right_fore + right_hind)
            self._readings.append((*reading.acceleration, *reading.angular_rate, *loads))
            targets = robot.generator.targets
            self._lags.append([abs(target - joint) for target, joint in zip(targets, reading.joints, strict=True)])

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        """Record the end of a phase."""
        if change is not None:
            self._gait.phase_change(self._ticks, change)
            if change.ended in self._phases and self._ticks >= self._settle:
                self._phases[change.ended].append(self._ticks - self._phase_began)
            self._phase_began = self._ticks

    def judge(self, torso: TorsoState) -> None:
        """Add the reward at the end of a tick: by the true state, and by what the sensors tell.

        :param torso: true state of the torso
        """
        self._ticks += 1
        if self._ticks <= self._settle:
            return
        if self._first is None:
            self._first, self._from = torso, (self._odometry.x, self._odometry.y)
        frequency = self._gait.steps_per_second(self._ticks)
        (x, y, z), (first_x, first_y, _) = torso.position, self._first.position
        self.true.value += self._reward_rate(x - first_x, y - first_y, z, frequency) * self._dt
        odometry, (from_x, from_y) = self._odometry, self._from
        self.observed.value += (
            self._reward_rate(odometry.x - from_x, odometry.y - from_y, self._height, frequency) * self._dt
        )

    def felt(self) -> tuple[float, ...]:
        """What the robot felt, in the order of :data:`FELT`; a phase that never ended lasted as long as the window."""
        if not self._readings:
            return (0.0,) * len(FELT)
        signals = np.array(self._readings)
        lags = np.array(self._lags).mean(axis=0).reshape(3, 2).mean(axis=1)
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


def observation_from(felt: Sequence[float], scale: Scale) -> np.ndarray:
    """Scale what a robot felt to an observation.

    :param felt: values in the order of :data:`FELT`, in SI units
    :param scale: size of the robot
    :return: float32 array of the same length, of order 1, clipped to [-5, 5]
    """
    scaled = np.array(felt) / scale.all_scaled(FELT_SIZES)
    return np.clip(np.where(np.isfinite(scaled), scaled, 0.0), -LARGEST, LARGEST).astype(np.float32)
