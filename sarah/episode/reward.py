"""Equation 2 of the paper, and the score that makes returns comparable."""

from __future__ import annotations

from sarah.episode.settings import HALF_WIDTH, STEP_FREQUENCY, EpisodeConfig, RewardForm
from sarah.episode.tick import Tick

LITTLE_LOST = 0.9
"""Share of the reward that a robot's natural step frequency should have at least."""


def reward_rate(
    x: float,
    y: float,
    height: float,
    steps_per_second: float,
    form: RewardForm = "symmetric",
    half_width: float = HALF_WIDTH,
    step_frequency: float = STEP_FREQUENCY,
) -> float:
    """Reward R of equation 2: (0.5 - c_x) (0.5 - c_y) 2^(-(f - 3)^4) c_z.

    The printed equation has no absolute values and so rewards drifting towards negative x and y. The symmetric
    form uses ``max(0.5 - |c|, 0)`` instead, which is largest at the start position. Where another frequency f0 than 3
    is rewarded, its factor is 2^(-(3 (f / f0 - 1))^4): a frequency counts by its ratio to the rewarded one.

    :param x: displacement c_x of the torso from its start to the right, in m
    :param y: displacement c_y of the torso from its start forward, in m
    :param height: height c_z of the torso's centre over the floor, in m
    :param steps_per_second: frequency f of the steps, in 1/s
    :param form: form of the equation: ``"symmetric"``, or ``"printed"`` for the equation to the letter
    :param half_width: displacement at which the reward is zero, in m: the equation's 0.5
    :param step_frequency: rewarded frequency f0, in 1/s: the equation's 3
    :return: reward per second
    """
    deviation = (steps_per_second - step_frequency) * (STEP_FREQUENCY / step_frequency)
    frequency_factor = 2.0 ** -(deviation**4)
    if form == "printed":
        return (half_width - x) * (half_width - y) * frequency_factor * height
    return max(half_width - abs(x), 0.0) * max(half_width - abs(y), 0.0) * frequency_factor * height


def equation_2(tick: Tick, config: EpisodeConfig) -> float:
    """Reward of both tasks of the paper, per second: equation 2 at the end of a control tick.

    :param tick: what is known at the end of the tick
    :param config: settings of the episode, which name the form of the equation, its half width and its frequency
    """
    form, half_width, step_frequency = config.reward_form, config.reward_half_width, config.step_frequency
    return reward_rate(tick.x, tick.y, tick.height, tick.steps_per_second, form, half_width, step_frequency)


def natural_step_frequency(config: EpisodeConfig) -> float:
    """Steps per second of a robot that rocks by itself, as a pendulum of its height: 3 for the default robot.

    Its width and where its mass lies are left out: robots whose hips are closer than 0.1 m, or whose torso has most of
    the mass, step more slowly than that.

    :param config: settings of the episodes, whose shortest phases are an upper bound
    """
    phases = 3 * config.controller.minimum_phase_seconds  # SHIFT, LIFT and LAND
    by_pendulum = STEP_FREQUENCY / config.scale.time
    return min(by_pendulum, 1.0 / phases) if phases else by_pendulum


def frequency_hint(config: EpisodeConfig) -> str | None:
    """Sentence that says which step frequency suits a robot; ``None`` where the rewarded one does.

    :param config: settings of the episodes
    """
    natural = natural_step_frequency(config)
    if reward_rate(0.0, 0.0, 1.0, natural, half_width=1.0, step_frequency=config.step_frequency) >= LITTLE_LOST:
        return None
    return (
        f"a robot of this height steps {natural:.2g} times per second by itself, and "
        f"{config.step_frequency:g} are rewarded: --episode.step-frequency {natural:.2g} suits it"
    )


def highest_return(standing_height: float, seconds: float, half_width: float = HALF_WIDTH) -> float:
    """Ceiling of the symmetric return: standing height, start position and the rewarded step frequency all along.

    :param standing_height: height of the standing torso's centre over the floor, in m
    :param seconds: time that the pattern generator runs, in s
    :param half_width: displacement at which the reward is zero, in m
    """
    return half_width * half_width * standing_height * seconds
