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
    :param stale_seconds: age from which a reading counts as missing, in s; after as long without a new one the robot
        stands until one comes
    :param lost_seconds: time for which all inertial signals may be missing, or stay the same, before the robot stops,
        in s
    :param signal_seconds: time for which one inertial signal may be missing, or stay the same, before the robot stops,
        in s
    :param stepless_seconds: time without a step after which the robot stops, in s
    :param largest_tilt: tilt of the torso from which the robot counts as fallen, in rad; robots come back from less
    :param largest_servo_error: mean distance of a hip joint from its target beyond which its servo does not follow, in
        rad
    :param servo_seconds: time constant of the mean distance of a hip joint from its target, in s
    :param lean_seconds: time constant with which the torso's tilt follows the accelerometer, in s
    :param largest_contradiction: largest difference between the mean rate about x and the change of the accelerometer's
        lean, over twice lean_seconds, in rad/s; beyond it one of the two is wrong
    :param least_rocking: smallest root mean square of the rate about y over lean_seconds, while the pads show rocking,
        in rad/s; below it the gyroscope does not feel the rocking
    :param largest_lateness: largest mean delay of the last hundred ticks or so, in control periods
    """

    enabled: bool = False
    stale_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.08
    lost_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.55
    signal_seconds: Annotated[float, Sized(0.001, 10.0, "s")] = 0.1
    stepless_seconds: Annotated[float, Sized(0.1, 100.0, "s")] = 2.0
    largest_tilt: Annotated[float, Within(0.01, 1.5, "rad")] = 0.5
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
