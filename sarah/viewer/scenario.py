"""An episode as the values of the page's sliders, and back."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, replace
from typing import Any

from sarah.episode.push import NO_PUSH, Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of, push_of
from sarah.episode.tasks import BALANCE, BalanceConfig, Task
from sarah.simulation.terrain import Terrain, draw_terrain


@dataclass(frozen=True)
class Scenario:
    """An episode as one value for every slider.

    :param stepping: values of P1 to P5
    :param balance: values of V1 to V4; zeros lock the hips, as in the First Training
    :param push: push of the episode, whose settings are single values
    :param terrain: ground of the episode, whose settings are single values
    :param seed: seed of the conditions, the bumps and the sensor noise
    :param config: settings that the sliders do not change
    :param task: task whose reward and ending the episode has
    """

    stepping: tuple[float, ...]
    balance: tuple[float, ...]
    push: Push
    terrain: Terrain
    seed: int
    config: BalanceConfig
    task: Task[Any] = BALANCE

    @classmethod
    def of(cls, spec: EpisodeSpec) -> Scenario:
        """Make the scenario of an episode.

        :param spec: specification of any task; push and ground that its seed draws become given ones
        """
        task = spec.task
        stepping, balance = controller_of(task, spec.parameters, spec.config)
        drawn, push = push_of(task, spec.config, spec.seed), NO_PUSH
        if drawn is not None:
            x, y, _ = drawn.force
            newtons, degrees = math.hypot(x, y), math.degrees(math.atan2(y, x)) % 360.0
            duration = max(drawn.duration, spec.config.physics.control_dt)
            push = Push((newtons, newtons), (degrees, degrees), (drawn.begin, drawn.begin), duration)
        hips = BALANCE.baseline if balance is None else astuple(balance)
        terrain = draw_terrain(spec.config.terrain, spec.seed)
        return cls(astuple(stepping), hips, push, terrain, spec.seed, BALANCE.config_of(spec.config), task)

    def spec(self) -> EpisodeSpec:
        """Specification of the episode, with the settings of balance, which has everything that the sliders can set."""
        config = BALANCE.config_of(self.config, stepping=self.stepping, push=self.push, terrain=self.terrain)
        judged = {name: getattr(self.task, name) for name in ("reward", "best_reward", "ending", "file")}
        own = {name: value for name, value in judged.items() if value != getattr(BALANCE, name)}
        return EpisodeSpec(self.balance, self.seed, replace(BALANCE, **own) if own else BALANCE, config)
