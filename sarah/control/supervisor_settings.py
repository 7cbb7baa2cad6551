"""Settings of a supervisor: from when on something is a fault."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from sarah.ranges import Within, check_ranges
from sarah.robot.scale import Sized


@dataclass(frozen=True)
class SupervisorSettings:
    """Settings of a supervisor: from when on something is a fault.

    :param enabled: whether a supervisor watches, and stops the robot when something fails
    :param stale_seconds: age from which a reading counts as missing, and time without a new one after which the robot
        stands until there is one again, in s
    :param lost_seconds: time without any inertial signal, or with all of them the same, after which the robot stops, in
        s
    :param signal_seconds: time without one of them, or with one that stays the same, after which it stops, in s
    :param stepless_seconds: time without a step after which it stops, in s
    :param largest_tilt: tilt of the torso from which the robot counts as fallen, in rad
    :param largest_servo_error: mean distance of a hip joint from its target beyond which its servo does not follow, in
        rad
    :param servo_seconds: time constant of that mean, in s
    :param lean_seconds: time constant with which the torso's tilt follows the accelerometer, in s
    :param largest_contradiction: difference between the mean rate about x and that of the lean that the accelerometer
        shows, over twice that time, from which one of them is wrong, in rad/s
    :param least_rocking: rate about y, as a root mean square over that time, below which the gyroscope does not feel
        the rocking that the pads show, in rad/s
    :param largest_lateness: time that ticks may come late, in control periods, as a mean over the last hundred or so
    """

    enabled: bool = False
    stale_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.08
    lost_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.55
    signal_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.1
    stepless_seconds: Annotated[float, Sized(0.1, 100.0, "s")] = 2.0
    largest_tilt: Annotated[float, Within(0.01, 1.5, "rad")] = 0.35
    largest_servo_error: Annotated[float, Within(0.001, 1.5, "rad")] = 0.15
    servo_seconds: Annotated[float, Sized(0.01, 10.0, "s")] = 0.3
    lean_seconds: Annotated[float, Sized(0.1, 100.0, "s")] = 1.0
    largest_contradiction: Annotated[float, Sized(0.001, 10.0, "rad/s")] = 0.065
    least_rocking: Annotated[float, Sized(0.0, 10.0, "rad/s")] = 0.04
    largest_lateness: Annotated[float, Within(0.0, 100.0)] = 0.4

    def __post_init__(self) -> None:
        """Refuse settings with which nothing can be watched."""
        check_ranges("supervisor.", self)


STANDARD_SUPERVISOR = SupervisorSettings(enabled=True)
"""Settings of a supervisor for the default robot."""
