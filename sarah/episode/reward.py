"""Equation 2 of the paper, and the score that makes returns comparable."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated, Literal

from sarah.episode.robot_settings import RobotSettings
from sarah.episode.tick import Tick
from sarah.ranges import Within
from sarah.robot.scale import Sized

RewardForm = Literal["symmetric", "printed"]
STEP_FREQUENCY = 3.0
"""Rewarded number of steps per second by default; it is the paper's."""
LITTLE_LOST = 0.9
"""Share of the reward that a robot's natural step frequency should have at least."""


@dataclass(frozen=True)
class RewardSettings(RobotSettings):
    """Settings of the reward.

    :param reward_form: form of the reward, the paper's equation 2: ``symmetric``, or ``printed`` for the equation as
        printed
    :param step_frequency: rewarded number of steps per second; the paper's is 3
    :param reward_half_width: displacement from the start at which the reward is zero, in m; the paper's is 0.5
    """

    reward_form: RewardForm = "symmetric"
    step_frequency: Annotated[float, Within(0.1, 100.0, "per second")] = STEP_FREQUENCY
    reward_half_width: Annotated[float, Sized(0.001, 100.0, "m", usual=0.5)] = None  # type: ignore[assignment]


def reward_rate(
    x: float, y: float, height: float, steps_per_second: float, config: RewardSettings = RewardSettings()
) -> float:
    """Reward R of equation 2: (0.5 - c_x) (0.5 - c_y) 2^(-(f - 3)^4) c_z.

    The printed equation has no absolute values and so rewards drifting towards negative x and y. The symmetric
    form uses ``max(0.5 - |c|, 0)`` instead, which is largest at the start position. Where another frequency f0 than 3
    is rewarded, its factor is 2^(-(3 (f / f0 - 1))^4): a frequency counts by its ratio to the rewarded one.

    :param x: displacement c_x of the torso from its start to the right, in m
    :param y: displacement c_y of the torso from its start forward, in m
    :param height: height c_z of the torso's centre over the floor, in m
    :param steps_per_second: frequency f of the steps, in 1/s
    :param config: settings: form of the equation, its half width 0.5 and its frequency 3
    :return: reward per second
    """
    half_width, step_frequency = config.reward_half_width, config.step_frequency
    deviation = (steps_per_second - step_frequency) * (STEP_FREQUENCY / step_frequency)
    frequency_factor = 2.0 ** -(deviation**4)
    if config.reward_form == "printed":
        return (half_width - x) * (half_width - y) * frequency_factor * height
    return max(half_width - abs(x), 0.0) * max(half_width - abs(y), 0.0) * frequency_factor * height


def equation_2(tick: Tick, config: RewardSettings) -> float:
    """Reward of both tasks of the paper, per second: equation 2 at the end of a control tick.

    :param tick: what is known at the end of the tick
    :param config: settings of the episode
    """
    return reward_rate(tick.x, tick.y, tick.height, tick.steps_per_second, config)


def natural_step_frequency(config: RewardSettings) -> float:
    """Steps per second of a robot that rocks by itself, as a pendulum of its height: 3 for the default robot.

    Its width and where its mass lies are left out: robots whose hips are closer than 0.1 m, or whose torso has most of
    the mass, step more slowly than that.

    :param config: settings of the episodes, whose shortest phases are an upper bound
    """
    phases = 3 * config.controller.minimum_phase_seconds  # SHIFT, LIFT and LAND
    by_pendulum = STEP_FREQUENCY / config.scale.time
    return min(by_pendulum, 1.0 / phases) if phases else by_pendulum


def frequency_hint(config: RewardSettings) -> str | None:
    """Sentence that says which step frequency suits a robot; ``None`` where the rewarded one does.

    :param config: settings of the episodes
    """
    natural = natural_step_frequency(config)
    if highest_return(1.0, LITTLE_LOST, config) <= reward_rate(0.0, 0.0, 1.0, natural, config):
        return None
    return (
        f"a robot of this height steps {natural:.2g} times per second by itself, and "
        f"{config.step_frequency:g} are rewarded: --episode.step-frequency {natural:.2g} suits it"
    )


def highest_return(standing_height: float, seconds: float, config: RewardSettings = RewardSettings()) -> float:
    """Ceiling of the return: standing height, start position and the rewarded step frequency all along.

    :param standing_height: height of the standing torso's centre over the floor, in m
    :param seconds: time that the pattern generator runs, in s
    :param config: settings of the reward
    """
    return reward_rate(0.0, 0.0, standing_height, config.step_frequency, config) * seconds
