"""``sarah-robot``: run the controller on a robot, simulated or not."""

from __future__ import annotations

import contextlib
import dataclasses
import itertools
import signal
import sys
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.endpoints import endpoint_of, with_endpoint
from sarah.cli.episode_options import EpisodeOptions, parse_episode_options
from sarah.cli.interruption import SIGNALS, first_signal_noted
from sarah.cli.options import as_command, named_task, say_engine
from sarah.cli.robot_progress import Progress
from sarah.cli.subjects import learned_of
from sarah.control.hip_law import LOCKED_HIPS
from sarah.control.parameters import Parameters
from sarah.control.supervisor import State, Supervisor
from sarah.drivers.driver_file import mistakes_of, read_driver
from sarah.drivers.faults import FAULTS
from sarah.drivers.loop import ControlLoop, Lockstep, LoopObserver, controller_for
from sarah.drivers.real_time import RealTime, undisturbed
from sarah.drivers.simulated_robot import FaultPlan, SimulatedRobot, simulated_loop
from sarah.episode.push import NO_PUSH, PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.errors import ConfigurationError, unknown_name
from sarah.operation.window import Window
from sarah.ranges import Within
from sarah.remote.answers import Measured
from sarah.remote.identity import identity_of
from sarah.remote.measurement import Meter
from sarah.remote.requests import LARGEST_CHANGE, LearnedWith
from sarah.remote.server import Server
from sarah.remote.slot import Slot

if TYPE_CHECKING:
    from sarah.logs.robot_log import RobotLog

COMMAND = "sarah-robot"
STOP_SECONDS = 1.0
"""Time that a robot has to stop in the end, in s; it takes some tenths."""
OF_SIMULATION = ("--engine", "--physics", "--seed")
"""Options of the simulated robot alone."""
ANYWHERE = 20.0
"""Displacement at which the default robot ends, in m: it may go where it wants. It goes with the robot's length."""


@dataclass(frozen=True)
class RobotOptions(EpisodeOptions):
    """Run the controller on a robot: tick by tick, with a supervisor that stops it when something fails.

    Without --driver the robot is simulated. It may leave its place, and is not pushed, unless options say otherwise.
    With --listen it goes on where an episode would end, and is set upright two seconds after a fall. Ctrl-C lets it
    stop and stand; a second Ctrl-C ends at once.

    :param subject: run folder; numbers separated by commas, P1 to P5 for stepping, or V1 to V4 for the task balance; or
        the name of shipped parameters: ``paper``, ``stepping`` or ``balance``
    :param driver: file of a robot's driver and its name in there, such as my_robot.py:ROBOT. The file is run
    :param seconds: time for which it runs, the second of standing included, in s; by default until Ctrl-C or, without
        --listen, until the simulated episode ends
    :param real_time: whether a tick begins each control period by the clock; without it, ticks follow each other as
        fast as they can
    :param stand: whether the robot only stands
    :param log: file to log to, such as run.mcap; sarah-log reads it
    :param read_only: whether to read and compute without sending anything to the robot; lines then show its signals
    :param listen: address at which ``sarah-push`` reaches the robot; without an address tcp/127.0.0.1:7447, which is
        open to every user of this machine. Other machines need an address tls/… and certificates
    :param lockstep: whether the simulated robot waits for the learner of ``sarah-operate --robot`` between windows: no
        time passes while nobody asks it for something
    :param largest_change: largest change of a parameter by a push, as a share of its range
    :param authority: for TLS: certificate of the authority that has signed those of robot and pushers, a PEM file
    :param certificate: for TLS: certificate of the robot, a PEM file
    :param key: for TLS: private key of that certificate, a PEM file
    :param seed: seed of the simulated robot, its sensors and its push
    :param fault: what fails on the simulated robot, by its name in the table of docs/how_to/real_robot.md, such as
        ``rate about y: 0``
    :param fault_after: time after standing at which it fails, in s
    """

    subject: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]")] = "balance"
    driver: Annotated[str | None, tyro.conf.arg(metavar="FILE:NAME")] = None
    seconds: Annotated[float, Within(1.1, 1e7, "s")] | None = None
    real_time: bool = False
    stand: bool = False
    log: Annotated[Path | None, tyro.conf.arg(metavar="FILE.mcap")] = None
    read_only: bool = False
    listen: Annotated[str | None, tyro.conf.arg(metavar="[ENDPOINT]")] = None
    lockstep: bool = False
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
            raise ConfigurationError(f"{message} (docs/how_to/real_robot.md has the table, such as 'rate about y: 0')")
        if self.driver is not None and self.fault != "none":
            raise ConfigurationError("--fault is for the simulated robot: leave out --driver or --fault")
        if self.driver is not None and not self.real_time:
            raise ConfigurationError("--driver needs --real-time: a robot's time passes by the clock")
        if self.lockstep and self.real_time:
            raise ConfigurationError("--lockstep stops the robot's time: leave out --lockstep or --real-time")
        if self.lockstep and self.listen is None:
            raise ConfigurationError("--lockstep waits for those who reach the robot: it needs --listen")


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = with_endpoint(sys.argv[1:])
    options = parse_episode_options(COMMAND, arguments, RobotOptions(), adapted=_supervised)
    own, _ = learned_of(options.subject, named_task(options.task))
    spec = options.applied_to(own)
    words = [argument.partition("=")[0] for argument in arguments]
    if options.driver is not None and (given := [name for name in OF_SIMULATION if name in words]):
        raise ConfigurationError(f"{given[0]} is for the simulated robot: leave out --driver or {given[0]}")
    if options.stand and not spec.config.supervisor.enabled:
        raise ConfigurationError("--stand needs a supervisor: leave --no-supervisor out")
    if options.listen is not None and not spec.config.supervisor.enabled:
        raise ConfigurationError("--listen needs a supervisor: leave --no-supervisor out")
    if options.seconds is not None and options.driver is None:
        time_limit = options.seconds + STOP_SECONDS
        spec = dataclasses.replace(spec, config=dataclasses.replace(spec.config, time_limit=time_limit))
    message = f"{COMMAND}: the robot stops and stands; a second signal ends at once"
    with first_signal_noted(message, (*SIGNALS, signal.SIGHUP)) as is_interrupted:
        _run(options, spec, is_interrupted)


def _supervised(config: EpisodeConfig, subject: str | None) -> EpisodeConfig:
    """Settings with a supervisor, for a robot that may go where it wants, and that nobody pushes."""
    supervisor = dataclasses.replace(config.supervisor, enabled=True)
    config = dataclasses.replace(config, supervisor=supervisor, box_half_width=ANYWHERE)
    return dataclasses.replace(config, push=NO_PUSH) if isinstance(config, PushedConfig) else config


def _run(options: RobotOptions, spec: EpisodeSpec, is_interrupted: Callable[[], bool]) -> None:
    with contextlib.ExitStack() as stack:
        progress = Progress(spec.config.physics.control_dt, options.read_only)
        stack.callback(progress.close)
        loop = _loop(options, spec, [progress])
        stack.callback(loop.driver.close)
        server = meter = None
        if options.listen is not None:
            meter = None if options.read_only else _meter(spec, loop)
            server = stack.enter_context(contextlib.closing(_server(options, spec, meter, is_interrupted)))
            loop.observers = (*loop.observers, server)
        if options.driver is None:
            say_engine(spec.config)
            print(_simulated(options, spec), file=sys.stderr)
        values = {**vars(loop.parameters), **vars(loop.balance)}
        print(", ".join(f"{name} {value:.3g}" for name, value in values.items()), file=sys.stderr)
        log = None if options.log is None else stack.enter_context(_logged(options, spec, loop))
        if log is not None and meter is not None:
            meter.watch = partial(_log_window, log, itertools.count(), loop.dt)
        if not options.read_only:
            stack.callback(loop.driver.off)  # before the log is completed, for which a disk may take its time
        if options.real_time:
            print(stack.enter_context(undisturbed(() if server is None else (server.thread,))), file=sys.stderr)
        if options.driver is not None:
            stack.enter_context(mistakes_of(options.driver))
        while loop.tick():
            is_over = options.seconds is not None and progress.seconds >= options.seconds - 1.5 * loop.dt
            if (is_over or is_interrupted()) and not _still_moves(loop):
                break
    progress.report(loop.driver, options.real_time)
    if server is not None and server.failure:
        print(f"something was not read or sent: {server.failure}", file=sys.stderr)
    if log is not None and (log.dropped or log.failure):
        print(f"{log.dropped} messages are not in {options.log}: {log.failure or 'the disk was slow'}", file=sys.stderr)


def _logged(options: RobotOptions, spec: EpisodeSpec, loop: ControlLoop) -> RobotLog:
    """The log of a loop. It never holds a robot up; a simulation in lockstep waits for it."""
    from sarah.logs.controller_log import log_loop
    from sarah.logs.robot_log import RobotLog
    from sarah.logs.simulated import about_robot

    assert options.log is not None
    facts = {"driver": options.driver} if options.driver else {"seed": str(options.seed), "fault": options.fault}
    about = about_robot(spec.config, COMMAND, task=spec.task.reference, subject=options.subject, **facts)
    log = RobotLog(options.log, about, waits=not options.real_time)
    log_loop(loop, log, COMMAND)
    return log


def _meter(spec: EpisodeSpec, loop: ControlLoop) -> Meter:
    """What the robot measures windows by. A simulated one also knows what is true."""
    return Meter(spec.config, loop.driver if isinstance(loop.driver, SimulatedRobot) else None)


def _log_window(log: RobotLog, numbers: Iterator[int], dt: float, parameters: Parameters, measured: Measured) -> None:
    """Log a window that is over."""
    worth = (measured.score, measured.observed_reward, measured.fell, tuple(measured.felt))
    window = Window(next(numbers), measured.began, round(measured.ticks * dt, 9), 0, parameters, *worth)
    log.window(window.end, window.plain())


def _server(options: RobotOptions, spec: EpisodeSpec, meter: Meter | None, is_over: Callable[[], bool]) -> Server:
    """What lets others reach the robot."""
    assert options.listen is not None
    server = Server(
        endpoint_of(options.listen, options.authority, options.certificate, options.key),
        LearnedWith.of(spec.config),
        Slot(spec.config.physics.control_dt, options.largest_change, meter),
        identity_of(
            spec.config,
            options.driver or _simulated(options, spec),
            options.lockstep,
            meter is not None and meter.truth is not None,
        ),
        lambda: options.lockstep and not is_over(),
    )
    print(f"listening at {options.listen}", file=sys.stderr)
    return server


def _loop(options: RobotOptions, spec: EpisodeSpec, observers: Sequence[LoopObserver]) -> ControlLoop:
    """The control loop of the robot that the options name."""
    config, dt = spec.config, spec.config.physics.control_dt
    pacing = RealTime(dt) if options.real_time else None
    if options.driver is None:
        plan = FaultPlan(FAULTS[options.fault], options.fault_after)
        seeded, goes_on = dataclasses.replace(spec, seed=options.seed), options.listen is not None
        _, loop = simulated_loop(seeded, plan, pacing, observers, goes_on=goes_on)
    else:
        driver = read_driver(options.driver)
        stepping, balance = controller_of(spec.task, spec.parameters, config)
        controller = controller_for(config, driver.limits)
        loop = ControlLoop(driver, controller, stepping, balance or LOCKED_HIPS, dt, pacing or Lockstep(), observers)
    loop.is_read_only = options.read_only
    if options.stand:
        _still_moves(loop)
    return loop


def _simulated(options: RobotOptions, spec: EpisodeSpec) -> str:
    """How the robot is simulated, in words."""
    failing = "" if options.fault == "none" else f", from {1.0 + options.fault_after:g} s on: {options.fault}"
    return f"simulated by {spec.config.engine}, seed {options.seed}{failing}"


def _still_moves(loop: ControlLoop) -> bool:
    """Ask the robot to stand; whether it does not yet."""
    controller = loop.controller
    if not isinstance(controller, Supervisor) or controller.state is State.FALLEN:
        return False
    is_moving = controller.state is not State.STANDING or loop.ticks == 0
    controller.stand()
    return is_moving
