"""One episode as the page's sliders describe it, and back."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass

from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, TASKS, BalanceConfig


@dataclass(frozen=True)
class KnownPush:
    """A push that is not drawn, but given.

    :param newtons: of the force; 0 for no push
    :param degrees: of its direction: 0 pushes to the robot's right, 90 forward
    :param begin: simulated time at which it begins, in s
    """

    newtons: float
    degrees: float
    begin: float


NO_PUSH = KnownPush(0.0, 0.0, 1.0)


@dataclass(frozen=True)
class Scenario:
    """What an episode depends on, one value for every slider.

    :param stepping: P1 to P5
    :param balance: V1 to V4; zeros lock the hips, as the First Training has them
    :param push: the push
    :param seed: of the conditions and the sensor noise
    :param config: what the sliders leave alone
    """

    stepping: tuple[float, ...]
    balance: tuple[float, ...]
    push: KnownPush
    seed: int
    config: BalanceConfig

    @classmethod
    def of(cls, spec: EpisodeSpec) -> Scenario:
        """Read what an episode's specification amounts to.

        :param spec: specification of any task's; a push that it draws from its seed becomes a given one
        """
        task = TASKS[spec.task]
        stepping, balance = task.controller_parameters(spec.parameters, spec.config)
        drawn, push = task.draw_push(spec.config, spec.seed), NO_PUSH
        if drawn is not None:
            x, y, _ = drawn.force
            push = KnownPush(math.hypot(x, y), math.degrees(math.atan2(y, x)) % 360.0, drawn.begin)
        hips = BALANCE.baseline if balance is None else astuple(balance)
        return cls(astuple(stepping), hips, push, spec.seed, BALANCE.config_of(spec.config))

    def spec(self) -> EpisodeSpec:
        """The episode, as one of the balance task, which has all that the sliders can set."""
        given = Push(
            newtons=(self.push.newtons, self.push.newtons),
            degrees=(self.push.degrees, self.push.degrees),
            at_seconds=(self.push.begin, self.push.begin),
            duration=self.config.push.duration,
        )
        config = BALANCE.config_of(self.config, stepping=self.stepping, push=given)
        return EpisodeSpec(self.balance, self.seed, BALANCE.name, config)
