"""Robots with faults, which run by themselves in this process and are asked for windows as one that listens is."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from sarah.control.supervisor_settings import STANDARD_SUPERVISOR
from sarah.drivers.faults import FAULTS, Fault
from sarah.drivers.simulated_robot import FaultPlan, simulated_loop
from sarah.episode.push import NO_PUSH
from sarah.episode.running_robot import Observer
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.operation.settings import SHIPPED, OperationConfig
from sarah.operation.window import Window
from sarah.recorded.journal import Journal
from sarah.remote.driven_robot import DrivenRobot
from sarah.remote.measurement import Meter
from sarah.remote.remote_robot import RemoteRobot
from sarah.remote.slot import Slot

PAD, GYROSCOPE = FAULTS["one pad: 0 N"], FAULTS["rate about y: 0.1 rad/s too high"]
PAD_AND_GYROSCOPE = FaultPlan(Fault(lambda reading, before: PAD.change(GYROSCOPE.change(reading, before), before)), 0.0)
"""A dead pad, and a gyroscope that is off, from the first step on."""


class FaultyRobot(RemoteRobot):
    """A supervised robot with a dead pad and a gyroscope that is off. Nobody pushes it.

    :param config: settings of the operation
    :param seed: seed of robot, world and noise
    :param watch: function that is called with every window
    :param journal: journal of the windows
    :param observers: none: nobody observes a robot that runs by itself
    """

    def __init__(
        self,
        config: OperationConfig,
        seed: int,
        watch: Callable[[Window], None] | None = None,
        journal: Journal | None = None,
        observers: Sequence[Observer] = (),
    ) -> None:
        robot = BALANCE.config_of(config.robot, push=NO_PUSH, supervisor=STANDARD_SUPERVISOR)
        spec = EpisodeSpec(SHIPPED[-len(BALANCE.baseline) :], seed, BALANCE, robot)
        simulated, loop = simulated_loop(spec, PAD_AND_GYROSCOPE, goes_on=True)
        driven = DrivenRobot(loop, Slot(loop.dt, meter=Meter(robot, simulated)))
        super().__init__(config, lambda: driven, "experiment", watch, journal)
        self._simulated = simulated

    def close(self) -> None:
        """Give the physics engine's resources back."""
        super().close()
        self._simulated.close()
