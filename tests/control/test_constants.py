"""The controller's constants: they are part of an episode's specification, and bad ones are refused."""

import pytest

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.robot.reading import SensorReading, Side


def stepping(**constants: float) -> EpisodeResult:
    config = EpisodeConfig(time_limit=4.0, controller=ControllerConstants(**constants))
    return simulate(EpisodeSpec(PAPER_STEPPING, 0, config=config))


def test_episodes_have_the_standard_constants_unless_others_are_given() -> None:
    assert EpisodeConfig().controller == BalanceConfig().controller == STANDARD_CONSTANTS == ControllerConstants()


def test_short_time_outs_end_the_phases_before_the_sensors_can() -> None:
    standard, hurried = stepping(), stepping(time_out_seconds=0.03)  # in 0.05 s MuJoCo's legs end most shifts
    assert standard.shifts_by_sensors > 0.9 and standard.lifts_by_sensors > 0.9
    assert hurried.shifts_by_sensors < 0.1 and hurried.score < standard.score


@pytest.mark.parametrize(
    "constants",
    [{"lift_retraction": 0.02}, {"shift_extension": 0.004}, {"tilt_time_constant": 0.15}, {"leg_speed": 0.5}],
)
def test_an_episode_depends_on_constants_of_the_pattern_generator(constants: dict[str, float]) -> None:
    assert stepping(**constants) != stepping()


def test_an_episode_depends_on_constants_of_the_hip_law() -> None:
    def pushed(**constants: float) -> EpisodeResult:
        config = BalanceConfig(
            time_limit=3.0,
            push=Push(newtons=100.0, degrees=90.0, at_seconds=1.5),
            controller=ControllerConstants(**constants),
        )
        return simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.5), 0, "balance", config))

    standard = pushed()
    for constants in (
        {"abduction_scale": 0.02},
        {"capture_gain": 0.3},
        {"fall_dead_band": 0.1},
        {"flexion_scale": 0.0},
        {"hip_speed": 1.0},
    ):
        assert pushed(**constants) != standard


def test_hips_keep_to_the_limits_that_are_given() -> None:
    law = HipLaw(
        BalanceParameters(2.0, 2.0, 2.0, -2.0), 0.01, ControllerConstants(largest_hip_angle=0.02, hip_speed=1.0)
    )
    before = 0.0
    for _ in range(50):
        law.sense(SensorReading((9.0, 0.0, 9.81), (2.0, 0.0, 0.0), (0.0, 0.0, 150.0, 150.0), (0.0,) * 6))
        law.tick()
        assert abs(law.abduction) <= 0.02 and abs(law.abduction - before) <= 0.01 + 1e-12
        before = law.abduction
    assert law.abduction == -0.02 and law.flexion[Side.LEFT] == -0.02
