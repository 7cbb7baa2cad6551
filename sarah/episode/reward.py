"""Equation 2 of the paper, and the score that makes returns comparable."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal

if TYPE_CHECKING:
    from sarah.episode.settings import EpisodeConfig
    from sarah.episode.tick import Tick

RewardForm = Literal["symmetric", "printed"]

HALF_WIDTH = 0.5
TARGET_STEPS_PER_SECOND = 3.0


def reward_rate(x: float, y: float, height: float, steps_per_second: float, form: RewardForm = "symmetric") -> float:
    """Reward R of equation 2: (0.5 - c_x) (0.5 - c_y) 2^(-(f - 3)^4) c_z.

    The printed equation has no absolute values and so rewards drifting towards negative x and y. The symmetric
    form uses ``max(0.5 - |c|, 0)`` instead, which is largest at the start position.

    :param x: displacement c_x of the torso from its start to the right, in m
    :param y: displacement c_y of the torso from its start forward, in m
    :param height: height c_z of the torso's centre over the floor, in m
    :param steps_per_second: frequency f of the steps, in 1/s
    :param form: form of the equation: ``"symmetric"``, or ``"printed"`` for the equation to the letter
    :return: reward per second
    """
    frequency_factor = 2.0 ** -((steps_per_second - TARGET_STEPS_PER_SECOND) ** 4)
    if form == "printed":
        return (HALF_WIDTH - x) * (HALF_WIDTH - y) * frequency_factor * height
    return max(HALF_WIDTH - abs(x), 0.0) * max(HALF_WIDTH - abs(y), 0.0) * frequency_factor * height


def equation_2(tick: Tick, config: EpisodeConfig) -> float:
    """Reward of both tasks of the paper, per second: equation 2 at the end of a control tick.

    :param tick: what is known at the end of the tick
    :param config: settings of the episode, which name the form of the equation
    """
    return reward_rate(tick.x, tick.y, tick.height, tick.steps_per_second, config.reward_form)


def highest_return(standing_height: float, seconds: float) -> float:
    """Ceiling of the symmetric return: standing height, start position and three steps per second all along.

    :param standing_height: height of the standing torso's centre over the floor, in m
    :param seconds: time that the pattern generator runs, in s
    """
    return HALF_WIDTH * HALF_WIDTH * standing_height * seconds
