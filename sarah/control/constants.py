"""The controller's own constants, which no training learns and no randomisation varies."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from sarah.ranges import Within, check_ranges
from sarah.robot.scale import ROCKING, Sized


@dataclass(frozen=True)
class ControllerConstants:
    """Time-outs, gains, time constants and lengths of the pattern generator and the hip law. All are reconstructed.

    :param baseline_time_constant: time constant of the slow baselines that are subtracted from the lateral acceleration
        and the rates about x and y, in s: longer than a step or a fall, shorter than a sensor's drift
    :param minimum_phase_seconds: shortest duration of a phase, in s
    :param time_out_seconds: shortest time-out of a phase, in s; P4 and P5 stretch it, by the factor 1 + P4 or 1 + P5
    :param landing_rate: rate of rocking back that P1 = 1 waits for before LIFT ends, in rad/s
    :param rate_scale: rate towards the stance leg that P3 = 1 waits for before SHIFT ends, in rad/s
    :param shift_extension: length by which the swing leg extends in SHIFT, in m
    :param lift_retraction: length by which the swing leg retracts in LIFT, in m
    :param leg_speed: speed of the ramp that leg length targets follow, in m/s
    :param tilt_time_constant: time constant of the tilt's low-pass, in s
    :param rate_time_constant: time constant of the rate's low-pass, in s
    :param abduction_tilt: tilt that each radian of the hip law's abduction counts as, V2's constant left out, in m/s^2
    :param abduction_rate_share: share of the abduction's rate that is added to the rate about y
    :param largest_acceleration: limit to which the lateral acceleration is clipped before all filters, in m/s^2
    :param abduction_scale: abduction per lateral acceleration at V1 = 1, in rad per m/s^2
    :param flexion_scale: constant flexion at V4 = 1, in rad; 0.1 rad would lean the robot over its toes
    :param largest_hip_angle: limit of either hip target, in rad
    :param hip_speed: speed of the ramp that hip targets follow, in rad/s
    :param stable_time_constant: time constant of the hips' own low-pass of the lateral acceleration, in s
    :param lean_time_constant: time constant of the leaky integral of a rate that belongs to a lean, in s: longer than a
        fall, and short enough to forget an error of the gyroscope
    :param fall_time_constant: time constant of the low-passes of a lean's rate and of the fall, in s
    :param fall_rate: rate at which a fall over a foot grows, in 1/s; the rate of a lean is divided by it
    :param fall_dead_band: fall below which the flexion does not react, in rad
    :param largest_servo_error: difference of a hip joint's position from its target beyond which it is not believed, in
        rad: more than a servo gives way under a robot that steps or is pushed
    :param capture_gain: flexion of an unloaded leg against the fall at V3 = 1, in rad per rad
    :param spread_gain: angle by which either leg spreads for the lean outward at V1 = 1, in rad per rad
    :param spread_dead_band: lean outward below which the legs do not spread, in rad: more than the robot leans while it
        steps with a V1 near 1
    :param spread_speed: speed at which the legs spread, in rad/s
    :param spread_return_speed: speed at which the legs close again, in rad/s: a quick return would tip the robot over
    :param pad_threshold: sum of a foot's two pads above which it counts as loaded, in N; a leg with less is free to
        flex against the fall
    :param largest_rate: limit to which rates about x and y are clipped before all filters, in rad/s
    :param balance_ramp: speed at which V1 to V4 move to new values while the robot steps, per second
    :param largest_blow: limit to which the vertical acceleration is clipped before it is low-passed, in m/s^2: as much
        as landing feet cause; a lower limit would clip one side only, and look like a lean
    :param upright_time_constant: time constant of the low-pass of the vertical acceleration that recognises a fall, in
        s: longer than a step, in which the acceleration swings about that of gravity
    :param least_upright: low-passed vertical acceleration of the torso below which the robot has fallen, in m/s^2
    """

    baseline_time_constant: Annotated[float, Sized(0.1, 10_000.0, "s")] = 8.0
    minimum_phase_seconds: Annotated[float, Sized(0.0, 1.0, "s")] = 0.04
    time_out_seconds: Annotated[float, Sized(0.01, 100.0, "s")] = 0.5
    landing_rate: Annotated[float, Sized(0.0, 1000.0, "rad/s")] = 1.0
    rate_scale: Annotated[float, Sized(0.0, 10.0, "rad/s")] = 0.01
    shift_extension: Annotated[float, Sized(0.0, 1.0, "m", ROCKING)] = 0.008
    lift_retraction: Annotated[float, Sized(0.0, 1.0, "m")] = 0.030
    leg_speed: Annotated[float, Sized(0.01, 100.0, "m/s")] = 1.0
    tilt_time_constant: Annotated[float, Sized(1e-4, 100.0, "s")] = 0.10
    rate_time_constant: Annotated[float, Sized(1e-4, 100.0, "s")] = 0.01
    abduction_tilt: Annotated[float, Within(0.0, 10_000.0, "m/s^2 per rad")] = 150.0
    abduction_rate_share: Annotated[float, Within(0.0, 10.0)] = 0.2
    largest_acceleration: Annotated[float, Within(0.1, 1000.0, "m/s^2")] = 20.0
    abduction_scale: Annotated[float, Within(0.0, 10.0, "rad per m/s^2")] = 0.05
    flexion_scale: Annotated[float, Within(0.0, 1.0, "rad")] = 0.02
    largest_hip_angle: Annotated[float, Within(0.0, 1.5, "rad")] = 0.3
    hip_speed: Annotated[float, Sized(0.01, 100.0, "rad/s")] = 6.0
    stable_time_constant: Annotated[float, Sized(1e-4, 100.0, "s")] = 0.30
    lean_time_constant: Annotated[float, Sized(0.02, 100.0, "s")] = 1.0  # a control period at least: a step of Euler's
    fall_time_constant: Annotated[float, Sized(1e-4, 100.0, "s")] = 0.03
    fall_rate: Annotated[float, Sized(0.1, 100.0, "1/s")] = 4.0
    fall_dead_band: Annotated[float, Within(0.0, 1.5, "rad")] = 0.03
    largest_servo_error: Annotated[float, Within(0.0, 10.0, "rad")] = 0.1
    capture_gain: Annotated[float, Within(0.0, 10.0)] = 0.6
    spread_gain: Annotated[float, Within(0.0, 10.0)] = 2.0
    spread_dead_band: Annotated[float, Within(0.0, 1.5, "rad")] = 0.15
    spread_speed: Annotated[float, Sized(0.01, 100.0, "rad/s")] = 1.5
    spread_return_speed: Annotated[float, Sized(0.01, 100.0, "rad/s")] = 1.0
    pad_threshold: Annotated[float, Sized(0.0, 100_000.0, "N")] = 30.0
    largest_rate: Annotated[float, Sized(0.1, 1000.0, "rad/s")] = 10.0
    balance_ramp: Annotated[float, Sized(0.01, 1000.0, "per second")] = 4.0
    largest_blow: Annotated[float, Within(0.1, 1000.0, "m/s^2")] = 40.0
    upright_time_constant: Annotated[float, Sized(1e-4, 100.0, "s")] = 0.5
    least_upright: Annotated[float, Within(-20.0, 20.0, "m/s^2")] = 5.0

    def __post_init__(self) -> None:
        """Refuse values that no controller can have."""
        check_ranges("controller.", self)


STANDARD_CONSTANTS = ControllerConstants()
"""The constants that trainings use."""
