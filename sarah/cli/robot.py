"""``sarah-robot``: run the controller on a robot, simulated or not."""

from __future__ import annotations

import contextlib
import dataclasses
import gc
import os
import sys
import threading
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.endpoints import endpoint_of, with_endpoint
from sarah.cli.episode_options import EpisodeOptions, parse_episode_options
from sarah.cli.interruption import interruptible
from sarah.cli.options import as_command, named_task, say_engine
from sarah.cli.subjects import learned_of
from sarah.control.hip_law import LOCKED_HIPS
from sarah.control.pattern_generator import Phase
from sarah.control.supervisor import State, Supervisor
from sarah.drivers.driver import Driver
from sarah.drivers.driver_file import read_driver
from sarah.drivers.faults import FAULTS
from sarah.drivers.loop import LATE_SECONDS, ControlLoop, Lockstep, LoopObserver, LoopTick, RealTime, controller_for
from sarah.drivers.simulated_robot import FaultPlan, simulated_loop
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.errors import ConfigurationError, unknown_name
from sarah.ranges import Within
from sarah.remote.requests import LARGEST_CHANGE, LearnedWith
from sarah.remote.server import Server

COMMAND = "sarah-robot"
ANYWHERE = 100.0
"""Displacement at which the simulated robot ends, in m: it may go where it wants."""
PRIORITY = 50
"""Priority in the real-time scheduling class."""
SWITCH_SECONDS = 0.0005
"""Time for which another thread may hold the interpreter, in s."""


@dataclass(frozen=True)
class RobotOptions(EpisodeOptions):
    """Run the controller on a robot: tick by tick, with a supervisor that stops it when something fails.

    Without --driver the robot is simulated. Ctrl-C lets it stop and stand, and a second one ends at once.

    :param subject: run folder; numbers separated by commas, P1 to P5 for stepping, or V1 to V4 for the task balance; or
        the name of shipped parameters: ``paper``, ``stepping`` or ``balance``
    :param driver: file of a robot's driver and its name in there, such as my_robot.py:ROBOT. The file is run
    :param seconds: time for which it runs, in s; by default until Ctrl-C, or the end of the simulated episode
    :param real_time: whether a tick begins each control period by the clock; without it, ticks follow each other as
        fast as they can
    :param stand: whether the robot only stands
    :param read_only: whether to read and compute without sending anything to the robot
    :param listen: address at which ``sarah-push`` reaches the robot; without an address tcp/127.0.0.1:7447, which is
        open to every user of this machine. Other machines need an address tls/… and certificates
    :param largest_change: largest change of a parameter by a push, as a share of its range
    :param authority: for TLS: certificate of the authority that has signed those of robot and pushers, a PEM file
    :param certificate: for TLS: certificate of the robot, a PEM file
    :param key: for TLS: private key of that certificate, a PEM file
    :param seed: seed of the simulated robot, its sensors and its push
    :param fault: what fails on the simulated robot, by its name in the table of docs/how_to/real_robot.md
    :param fault_after: time after standing at which it fails, in s
    """

    subject: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]")] = "balance"
    driver: Annotated[str | None, tyro.conf.arg(metavar="FILE:NAME")] = None
    seconds: Annotated[float, Within(0.1, 1e7, "s")] | None = None
    real_time: bool = False
    stand: bool = False
    read_only: bool = False
    listen: Annotated[str | None, tyro.conf.arg(metavar="[ENDPOINT]")] = None
    largest_change: Annotated[float, Within(0.0, 1.0)] = LARGEST_CHANGE
    authority: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    certificate: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    key: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    seed: int = 0
    fault: Annotated[str, tyro.conf.arg(metavar="NAME")] = "none"
    fault_after: Annotated[float, Within(0.0, 3600.0, "s")] = 3.0

    def __post_init__(self) -> None:
        """Refuse numbers outside their ranges, and faults of a robot that is not simulated."""
        super().__post_init__()
        if self.fault not in FAULTS:
            message = unknown_name("fault", self.fault, FAULTS).partition(" (allowed")[0]
            raise ConfigurationError(f"{message} docs/how_to/real_robot.md has the table of faults")
        if self.driver is not None and self.fault != "none":
            raise ConfigurationError("--fault is for the simulated robot: leave out --driver or --fault")
        if self.driver is not None and not self.real_time:
            raise ConfigurationError("--driver needs --real-time: a robot's time passes by the clock")


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = with_endpoint(sys.argv[1:])
    options = parse_episode_options(COMMAND, arguments, RobotOptions(), adapted=_supervised)
    own, _ = learned_of(options.subject, named_task(options.task))
    spec = options.applied_to(own)
    if options.seconds is not None and options.driver is None:
        spec = dataclasses.replace(spec, config=dataclasses.replace(spec.config, time_limit=options.seconds))
    with (
        _listening(options, spec) as others,
        interruptible(COMMAND, "step", "the robot was left as it was") as is_interrupted,
    ):
        _run(options, spec, others, is_interrupted)


def _supervised(config: EpisodeConfig, subject: str | None) -> EpisodeConfig:
    """Settings with a supervisor, for a robot that may go where it wants."""
    supervisor = dataclasses.replace(config.supervisor, enabled=True)
    return dataclasses.replace(config, supervisor=supervisor, box_half_width=ANYWHERE)


def _run(
    options: RobotOptions, spec: EpisodeSpec, others: Sequence[LoopObserver], is_interrupted: Callable[[], bool]
) -> None:
    progress = Progress(spec.config.physics.control_dt)
    loop = _loop(options, spec, [progress, *others])
    try:
        with _real_time() if options.real_time else contextlib.nullcontext():
            while loop.tick():
                if options.seconds is not None and loop.ticks * loop.dt >= options.seconds - loop.dt / 2:
                    break
                if is_interrupted() and not _still_moves(loop):
                    break
    finally:
        loop.driver.off()
    progress.report(loop.driver)


@contextlib.contextmanager
def _listening(options: RobotOptions, spec: EpisodeSpec) -> Iterator[list[LoopObserver]]:
    """Context in which others can reach the robot, if the options say so."""
    if options.listen is None:
        yield []
        return
    if not spec.config.supervisor.enabled:
        raise ConfigurationError("--listen needs a supervisor: leave --no-supervisor out")
    endpoint = endpoint_of(options.listen, options.authority, options.certificate, options.key)
    robot, dt = LearnedWith.of(spec.config), spec.config.physics.control_dt
    with contextlib.closing(Server(endpoint, robot, dt, options.largest_change)) as server:
        print(f"listening at {endpoint.address}", file=sys.stderr)
        yield [server]


def _loop(options: RobotOptions, spec: EpisodeSpec, observers: list[LoopObserver]) -> ControlLoop:
    """The control loop of the robot that the options name."""
    config, dt = spec.config, spec.config.physics.control_dt
    pacing = RealTime(dt) if options.real_time else None
    if options.driver is None:
        say_engine(config)
        plan = FaultPlan(FAULTS[options.fault], options.fault_after)
        _, loop = simulated_loop(dataclasses.replace(spec, seed=options.seed), plan, pacing, observers)
    else:
        driver = read_driver(options.driver)
        stepping, balance = controller_of(spec.task, spec.parameters, config)
        controller = controller_for(config, driver.limits)
        loop = ControlLoop(driver, controller, stepping, balance or LOCKED_HIPS, dt, pacing or Lockstep(), observers)
    loop.is_read_only = options.read_only
    if options.stand and not _still_moves(loop):
        raise ConfigurationError("--stand needs a supervisor: leave --no-supervisor out")
    return loop


def _still_moves(loop: ControlLoop) -> bool:
    """Ask the robot to stand; whether it does not yet."""
    controller = loop.controller
    if not isinstance(controller, Supervisor) or controller.state is State.FALLEN:
        return False
    is_moving = controller.state is not State.STANDING or loop.ticks == 0
    controller.stand()
    return is_moving


@contextlib.contextmanager
def _real_time() -> Iterator[None]:
    """Context in which this process is disturbed as little as the system grants."""
    switch = sys.getswitchinterval()
    with _scheduled():
        sys.setswitchinterval(SWITCH_SECONDS)
        gc.freeze()
        gc.disable()
        try:
            yield
        finally:
            gc.enable()
            gc.unfreeze()
            sys.setswitchinterval(switch)


@contextlib.contextmanager
def _scheduled() -> Iterator[None]:
    """Context in the real-time scheduling class, where the system has one and grants it.

    Other Python threads come right behind this one: the loop may wait for one of them to give the interpreter back.
    """
    threads = [thread.native_id or 0 for thread in threading.enumerate()]
    try:
        before = {thread: (os.sched_getscheduler(thread), os.sched_getparam(thread)) for thread in threads}
        for thread in threads:
            behind = thread != threading.get_native_id()
            os.sched_setscheduler(thread, os.SCHED_FIFO, os.sched_param(PRIORITY - behind))
    except (OSError, AttributeError) as error:
        print(f"real-time scheduling is not granted ({error}): other processes can make ticks late", file=sys.stderr)
        yield
        return
    print(f"real-time scheduling: SCHED_FIFO, priority {PRIORITY}", file=sys.stderr)
    try:
        yield
    finally:
        for thread, (policy, parameter) in before.items():
            with contextlib.suppress(ProcessLookupError):  # it may have ended
                os.sched_setscheduler(thread, policy, parameter)


class Progress:
    """Observer that prints a line a second, and what happened at the end.

    :param dt: control period, in s
    """

    def __init__(self, dt: float) -> None:
        self._dt = dt
        self._next = 1.0
        self._ticks = self._late = self._steps = self._steps_before = 0
        self._worst = self._seconds = 0.0

    def __call__(self, tick: LoopTick) -> None:
        """Count a tick, and print what the supervisor did."""
        self._ticks += 1
        self._seconds = tick.seconds
        if tick.late_seconds > LATE_SECONDS:
            self._late += 1
        self._worst = max(self._worst, tick.late_seconds)
        if tick.change is not None and tick.change.is_step:
            self._steps += 1
        controller = tick.controller
        if isinstance(controller, Supervisor) and controller.state_change is not None:
            print(f"{tick.seconds:8.2f} s  {controller.state.value}: {controller.state_change.reason}", flush=True)
        if tick.seconds >= self._next - self._dt / 2:
            self._next += 1.0
            self._line(tick)

    def _line(self, tick: LoopTick) -> None:
        """Print a line of progress on standard error."""
        controller, steps = tick.controller, self._steps - self._steps_before
        self._steps_before = self._steps
        state = controller.state.value if isinstance(controller, Supervisor) else "unsupervised"
        phase = "" if controller.phase is Phase.STAND else f", {controller.phase.value}"
        print(
            f"{tick.seconds:8.2f} s  {state}{phase}; {steps} steps per second; tilt {controller.tilt:+.2f} m/s²; "
            f"{self._late} late ticks",
            file=sys.stderr,
        )

    def report(self, driver: Driver) -> None:
        """Print what happened.

        :param driver: driver of the robot
        """
        print(f"{self._ticks} ticks in {self._seconds + self._dt:.2f} s, {self._steps} steps")
        print(f"{self._late} ticks later than {1000 * LATE_SECONDS:g} ms; the worst by {1000 * self._worst:.2f} ms")
        if driver.ended:
            print(f"the robot ended: {driver.ended}")
