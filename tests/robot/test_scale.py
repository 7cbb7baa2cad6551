"""Robots of other sizes: what goes with length and mass, by Froude's rule; and how targets go to their goals."""

from dataclasses import replace

import pytest

from sarah import Change, EpisodeConfig, OperationConfig, Push, PushedConfig
from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.episode.reward import frequency_hint, natural_step_frequency
from sarah.robot.description import describe_robot
from sarah.robot.dimensions import dimensions_alike, scale_of
from sarah.robot.filters import clipped, ramped
from sarah.robot.scale import Scale


def test_scale_is_that_of_height_mass_and_width() -> None:
    assert scale_of({}) == Scale() == describe_robot().scale
    assert scale_of(dimensions_alike(0.25, 0.1)) == Scale(0.25, 0.1, 0.25)
    assert scale_of({"thigh_length": 0.33 + 0.84}) == Scale(length=2.0)
    assert scale_of({"torso_mass": 23.0}) == Scale(mass=1.5)
    assert scale_of({"hip_offset": 0.26}) == Scale(width=2.0)
    assert describe_robot(dimensions_alike(1.7, 4.1)).scale == pytest.approx(scale_of(dimensions_alike(1.7, 4.1)))


def test_quantities_go_by_their_units() -> None:
    scale = Scale(length=0.25, mass=0.1, width=0.5)
    factors = {unit: scale.factor(unit) for unit in ("m", "s", "m/s", "rad/s", "N", "Nm", "kg m^2", "Nms/rad", "Ns/m")}
    expected = [0.25, 0.5, 0.5, 2.0, 0.1, 0.025, 0.00625, 0.0125, 0.2]
    assert list(factors.values()) == pytest.approx(expected)
    assert scale.factor("m/s^2") == scale.factor("rad") == 1.0
    assert scale.factor("m of rocking") == 1.0  # width^2 / length


def test_what_goes_with_the_size_does() -> None:
    config = PushedConfig(dimensions=dimensions_alike(0.25, 0.1))
    controller, drawn = config.controller, config.randomisation
    lengths = (controller.shift_extension, controller.lift_retraction, drawn.mass_offset, config.least_clearance)
    assert lengths == pytest.approx((0.002, 0.0075, 0.0025, 0.0025))
    assert (config.reward_half_width, config.box_half_width) == pytest.approx((0.125, 0.0625))
    assert (*config.terrain.cell, config.terrain.reach) == pytest.approx((0.0125, 0.0125, 0.175))
    assert (controller.time_out_seconds, controller.tilt_time_constant) == pytest.approx((0.25, 0.05))
    assert (controller.landing_rate, controller.rate_scale, controller.fall_rate) == pytest.approx((2.0, 0.02, 8.0))
    assert controller.pad_threshold == pytest.approx(3.0)
    assert (*config.push.newtons, config.push.duration) == pytest.approx((0.0, 10.0, 0.075))
    assert drawn.actuator_bandwidth == pytest.approx((80.0, 100.0))
    assert drawn.delay_seconds == 0.01 and config.time_limit == 30.0 and config.step_frequency == 3.0
    assert describe_robot(config.dimensions).efforts["left_leg_length"] == pytest.approx(100.0)
    assert config.physics.rate == 800


def test_what_is_given_stays() -> None:
    own = ControllerConstants(pad_threshold=5.0)
    config = PushedConfig(dimensions=dimensions_alike(0.25, 0.1), controller=own, push=Push(newtons=(7.0, 7.0)))
    assert config.controller == own and config.push == Push(newtons=(7.0, 7.0))
    assert describe_robot({**dimensions_alike(0.25, 0.1), "leg_effort": 150.0}).efforts["left_leg_length"] == 150.0
    assert replace(config, payload=1.0).controller == own


def test_settings_go_with_the_ratio_of_both_robots() -> None:
    settings = PushedConfig(payload=3.0, controller=replace(STANDARD_CONSTANTS, pad_threshold=60.0))
    small = settings.for_robot(dimensions_alike(0.25, 0.1))
    assert (small.payload, small.controller.pad_threshold) == pytest.approx((0.3, 6.0))
    assert small.for_robot(dimensions_alike(1.0, 1.0)).controller.pad_threshold == pytest.approx(60.0)
    assert settings.for_robot({"torso_width": 0.3}).controller == settings.controller
    by_hand = settings.for_robot(dimensions_alike(0.25, 0.1), PushedConfig()).controller
    assert by_hand.pad_threshold == 60.0 and by_hand.fall_rate == pytest.approx(8.0)
    assert settings.for_robot({"thigh_length": 0.3}, PushedConfig()).for_robot({}, PushedConfig()) == settings


def test_a_dimension_changed_in_operation_leaves_the_controller() -> None:
    config = OperationConfig(changes=(Change(0.1, {"dimensions": {"torso_mass": 16.0}}),))
    assert config.robot_after(1) == replace(config.robot, dimensions={"torso_mass": 16.0})


def test_another_engine_gets_the_inertia_of_the_robots_size() -> None:
    for engine in ("pybullet", "mujoco"):
        config = EpisodeConfig(dimensions=dimensions_alike(0.25, 0.1), engine=engine)
        there = replace(config, engine="pybullet")
        assert there.physics.added_plate_inertia == pytest.approx(0.003 * 0.00625)  # type: ignore[attr-defined]


def test_a_robot_is_told_if_its_step_frequency_is_not_rewarded() -> None:
    small = EpisodeConfig(dimensions=dimensions_alike(0.25, 0.1))
    assert natural_step_frequency(EpisodeConfig()) == 3.0 and frequency_hint(EpisodeConfig()) is None
    assert natural_step_frequency(small) == pytest.approx(6.0)
    assert "--episode.step-frequency 6 suits it" in str(frequency_hint(small))
    assert frequency_hint(replace(small, step_frequency=6.0)) is None
    hints = [frequency_hint(EpisodeConfig(step_frequency=rewarded)) for rewarded in (2.45, 2.55)]
    assert [hint is None for hint in hints] == [False, True]  # 3 per second earn 0.87 and 0.95 of the highest reward
    slow = replace(small, controller=replace(small.controller, minimum_phase_seconds=0.1))
    assert natural_step_frequency(slow) == pytest.approx(1 / 0.3)


def test_a_ramp_goes_by_its_largest_change_a_clip_to_its_limit() -> None:
    goals = (-1.0, -0.05, 0.05, 1.0)
    assert (
        [ramped(0.0, goal, 0.1) for goal in goals] == [clipped(goal, 0.1) for goal in goals] == [-0.1, -0.05, 0.05, 0.1]
    )
