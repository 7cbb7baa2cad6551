"""The motion of a logged robot, estimated from its sensors, as a record that pictures and the viewer show.

A log does not have the torso's pose. Its tilt follows from the gyroscope, as far as it goes to and fro; its place
follows from the legs that carry it in turn. Slow tilts, turning about the vertical, sliding, ankles and pushes are not
seen.
"""

from __future__ import annotations

import math
from collections import deque
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import Any, ClassVar

from sarah.episode.from_mapping import from_mapping
from sarah.episode.gait import SHORTEST_WINDOW_SECONDS, WINDOW_SECONDS
from sarah.episode.push import NO_PUSH
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.episode.trace import Trace
from sarah.errors import ConfigurationError
from sarah.formats import read_yaml
from sarah.logs.reading import Log
from sarah.logs.topic import Values
from sarah.logs.topics import PARAMETER_CHANGES, PHASE_CHANGES, TICKS, reading_of, targets_of
from sarah.operation.odometry import DRIFT_SECONDS, LegOdometry
from sarah.operation.settings import PARAMETERS
from sarah.robot.description import ANKLE_JOINTS, RobotDescription
from sarah.robot.filters import LowPass
from sarah.robot.reading import SensorReading, Side

LONGEST_SECONDS = 300.0
"""Longest log that is played, in s."""
LEAK_SECONDS = 2.0
"""Time constant of the leaky integral of the angular rates, in s: longer than a step, shorter than a drift."""
BIAS_TICKS = 100
"""Number of readings at the beginning whose mean angular rate is taken for an error."""
LONGEST_GAP = 0.5
"""Time between two ticks beyond which the robot has been set upright, in s."""
END = "end_of_log"
"""Way in which a log ends."""


class Attitude:
    """Tilt of a torso that is upright on average, by its gyroscope.

    :param readings: first readings, whose mean rates are taken for errors
    :param dt: control period, in s
    """

    def __init__(self, readings: list[SensorReading], dt: float) -> None:
        self.roll = 0.0
        """Angle about y, in rad."""
        self.pitch = 0.0
        """Angle about x, in rad."""
        self._dt = dt
        self._drift_x, self._drift_y = LowPass(DRIFT_SECONDS, dt), LowPass(DRIFT_SECONDS, dt)
        self._drift_x.value = fmean(reading.angular_rate[0] for reading in readings)
        self._drift_y.value = fmean(reading.angular_rate[1] for reading in readings)

    def tick(self, reading: SensorReading) -> None:
        """Follow one reading.

        :param reading: reading of a tick
        """
        w_x, w_y, _ = reading.angular_rate
        self.pitch += self._dt * (w_x - self._drift_x(w_x) - self.pitch / LEAK_SECONDS)
        self.roll += self._dt * (w_y - self._drift_y(w_y) - self.roll / LEAK_SECONDS)

    @property
    def orientation(self) -> tuple[float, float, float, float]:
        """Unit quaternion (x, y, z, w) of a turn by the pitch about x, and then by the roll about y."""
        x, y = math.sin(self.pitch / 2.0), math.sin(self.roll / 2.0)
        w_x, w_y = math.cos(self.pitch / 2.0), math.cos(self.roll / 2.0)
        return w_y * x, y * w_x, -y * x, w_y * w_x

    def height(self, reading: SensorReading, standing: float) -> float:
        """Height of the torso's centre over the foot that carries more, in m.

        :param reading: reading of the tick
        :param standing: height while the robot stands, in m
        """
        left_fore, left_hind, right_fore, right_hind = reading.pressures
        leg = 0 if left_fore + left_hind > right_fore + right_hind else 1
        lean_x, lean_y = self.roll + reading.joints[leg], self.pitch + reading.joints[2 + leg]
        return (standing - reading.joints[4 + leg]) * math.cos(lean_x) * math.cos(lean_y)


@dataclass(frozen=True)
class LoggedResult(EpisodeResult):
    """What a log tells of an episode."""

    unknown: ClassVar[frozenset[str]] = frozenset(
        ("score", "episode_return", "sole_clearance", "vibration", "actuator_power", "peak_hip_rate", "peak_leg_speed")
    )


def spec_of_log(path: Path) -> EpisodeSpec:
    """The robot of a log with its last parameters, as an episode of the task balance without a push.

    :param path: path of the log
    :raises ConfigurationError: if it is no log, or no parameters were applied in it
    """
    log, applied = Log(path), dict[str, float]()
    for message in log.messages():
        asked = log.values(message) if message.topic == PARAMETER_CHANGES.name else {"accepted": False}
        if asked["accepted"]:
            applied |= {one.name: asked[one.name] for one in PARAMETERS if one.name in asked}
    missing = [one.name for one in PARAMETERS if one.name not in applied]
    if missing:
        raise ConfigurationError(f"{path} does not say which {missing[0]} the robot had")
    values = [applied[parameter.name] for parameter in PARAMETERS]
    count = len(PARAMETERS) - len(BALANCE.parameters)
    robot = from_mapping(BALANCE.episode, {"dimensions": read_yaml(log.about.get("dimensions", "{}"))})
    push = robot.scale.scaled(NO_PUSH)
    config = BALANCE.config_of(robot.for_robot(robot.dimensions), stepping=tuple(values[:count]), push=push)
    return EpisodeSpec(tuple(values[count:]), 0, BALANCE, config)


def played(path: Path, robot: RobotDescription) -> LoggedResult:
    """The motion of a logged robot as the result of an episode, with an estimated trace.

    :param path: path of the log
    :param robot: its robot
    :raises ConfigurationError: if it is no log, is longer than :data:`LONGEST_SECONDS`, or has no readings
    """
    log = Log(path)
    ticks: list[tuple[Values, SensorReading]] = []
    changes: list[Values] = []
    reading: SensorReading | None = None
    for message in log.messages():
        if message.topic == PHASE_CHANGES.name:
            changes.append(log.values(message))
        elif message.topic == TICKS.name:
            values = log.values(message)
            found = reading_of(values)
            reading = found if found is not None and found.is_finite else reading
            if reading is not None:
                ticks.append((values, reading))
            if ticks and values["seconds"] - ticks[0][0]["seconds"] > LONGEST_SECONDS:
                cut = f"sarah-log {path} --cut 0 {LONGEST_SECONDS:g} --out part.mcap"
                raise ConfigurationError(f"{path} is longer than {LONGEST_SECONDS:g} s: play a part of it, by {cut}")
    if len(ticks) < 2:
        raise ConfigurationError(f"{path} has no readings to play")
    rows = _rows(ticks, [one["seconds"] for one in changes if one["is_step"]], robot)
    return _result(rows, changes)


def _rows(
    ticks: list[tuple[Values, SensorReading]], steps: list[float], robot: RobotDescription
) -> list[dict[str, Any]]:
    dt = ticks[1][0]["seconds"] - ticks[0][0]["seconds"]
    if not dt > 0.0:
        raise ConfigurationError("the ticks of the log are not in the order of time")
    rows: list[dict[str, Any]] = []
    before = -math.inf
    recent, coming = deque[float](), deque(steps)
    window = WINDOW_SECONDS * robot.scale.time
    for index, (values, reading) in enumerate(ticks):
        seconds = values["seconds"]
        if seconds - before > LONGEST_GAP:
            attitude = Attitude([one for _, one in ticks[index : index + BIAS_TICKS]], dt)
            odometry, began = LegOdometry(robot.standing_height, dt), seconds
        before = seconds
        attitude.tick(reading)
        odometry.tick(reading)
        while coming and coming[0] <= seconds:
            recent.append(coming.popleft())
        while recent and recent[0] < seconds + dt / 2.0 - window:
            recent.popleft()
        counted = max(SHORTEST_WINDOW_SECONDS * robot.scale.time, min(window, seconds - began))
        rows.append(
            {
                "time": seconds,
                "position": (odometry.x, odometry.y, attitude.height(reading, robot.standing_height)),
                "orientation": attitude.orientation,
                "joints": reading.joints,
                "ankles": (0.0,) * len(ANKLE_JOINTS),
                "targets": targets_of(values) or reading.joints,
                "pressures": reading.pressures,
                "acceleration": reading.acceleration,
                "angular_rate": reading.angular_rate,
                "phase": values["phase"],
                "stance": (Side.RIGHT if values["stance"] == str(Side.RIGHT) else Side.LEFT).value,
                "stable_x": math.nan,
                "tilt": values.get("tilt", math.nan),
                "rate": values.get("rate", math.nan),
                "steps_per_second": len(recent) / counted,
                "push": (0.0, 0.0, 0.0),
                "score": math.nan,
            }
        )
    return rows


def _result(rows: list[dict[str, Any]], changes: list[Values]) -> LoggedResult:
    seconds = rows[-1]["time"] - rows[0]["time"]
    steps = sum(one["is_step"] for one in changes)
    shares = {}
    for phase in ("shift", "lift"):
        by_sensors = [one["by_sensors"] for one in changes if one["ended"] == phase]
        shares[phase] = fmean(by_sensors) if by_sensors else 0.0
    return LoggedResult(
        termination=END,
        final_position=rows[-1]["position"],
        trace=Trace.of(rows),
        steps=steps,
        steps_per_second=steps / seconds if seconds else 0.0,
        duration=seconds,
        shifts_by_sensors=shares["shift"],
        lifts_by_sensors=shares["lift"],
        **dict.fromkeys(LoggedResult.unknown, 0.0),
    )
