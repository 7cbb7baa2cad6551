"""``sarah-operate``: let the robot run on, and renew its parameters from its own experience."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Callable, Sequence
from dataclasses import astuple, dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from sarah.cli.episode_options import EpisodeOptions, given_options, parse_episode_options
from sarah.cli.former_names import say_present, with_out
from sarah.cli.going_on import check_extendable, check_same, finished_words
from sarah.cli.next_steps import say_next, to_see, to_watch
from sarah.cli.operate_robot import check_effect, config_for, operate_robot, robot_found
from sarah.cli.operate_text import COMMAND, summarise, watched
from sarah.cli.operated import OperatedConfig, say_differences, settings_in_operation, times_of_session
from sarah.cli.options import as_command, named_task, say_engine
from sarah.cli.subjects import episode_of, is_shipped
from sarah.episode.push import NO_PUSH, PushedConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.episode.tasks import BALANCE, STEPPING
from sarah.errors import ConfigurationError, shortened
from sarah.formats import read_yaml
from sarah.logs.chunk_file import check_new
from sarah.number import number
from sarah.operation.settings import Change, OperationConfig, Parameters
from sarah.ranges import Within
from sarah.remote.remote_robot import GONE_SECONDS
from sarah.remote.requests import LearnedWith
from sarah.runs.kinds import SESSION
from sarah.runs.session import FORMER_LEARNERS, SessionSpec
from sarah.simulation.engines import check_engine

if TYPE_CHECKING:
    from sarah.recognition.recognition import Recognition
    from sarah.runs.session_folder import SessionFolder
    from sarah.training.operate import SessionResult

WITHOUT_EFFECT = ("--episode.time-limit", "--episode.reward-form", "--episode.push.at-seconds")
"""Options of episodes that an operation, which goes on and is pushed again and again, does not know."""


@dataclass(frozen=True)
class OperateOptions(EpisodeOptions):
    """Let the robot run in windows, and improve its nine parameters between them, using only its own sensors.

    Give --episode.… for what differs from the robot of the training, such as --episode.payload 5 or
    slower servos by --episode.randomisation.actuator-bandwidth 12, and --change for what changes during the session.

    :param subject: run folder of a training or a session, numbers separated by commas (P1 to P5, V1 to V4, or all
        nine), or the name of shipped parameters: what the robot begins with
    :param learner: ``none``, ``careful``, ``recognise``, ``naf``, ``cma-es`` or ``random``
    :param from_run: folder of sarah-train --offline, for learner ``recognise``: what logs teach; by default what the
        package ships
    :param minutes: duration of the operation, in min
    :param seed: seed of robot, world, noise, pushes and learner
    :param settle_seconds: time that a window gives new parameters to settle, in s
    :param measure_seconds: time that a window measures, in s
    :param fall_seconds: time that a fall costs, in s
    :param push_seconds: time from a push to the next, in s; --episode.push.newtons sets their force
    :param change: change and its minute, such as "5: randomisation.actuator_bandwidth=12" at minute 5; once for each
        change, in the order of time
    :param out: folder to write, new or empty; by default a new one, runs/operation/<learner>-s<seed>
    :param resume: folder of an interrupted session to continue with its settings. A finished session continues if
        --minutes is more than its duration. Its windows are then those of a session that was as long from the
        beginning, unless the learner is careful, which tries less shortly before an end
    :param extended_from: durations before the session was made longer, in min, in rising order; --resume with more
        --minutes adds one
    :param compare_frozen: whether to run the same robot again without learning, with its first parameters throughout,
        and to show both. It takes as long again, and changes nothing in the session
    :param log: MCAP file for a log of the session from its beginning, which must be new; sarah-log reads it
    :param robot: address of a robot that runs by itself, with ``sarah-robot --listen``, such as tcp/127.0.0.1:7447: it
        is operated instead of a simulated one. The seed is then the learner's only
    :param gone_seconds: with --robot: time after which a robot that has gone is given up, in s
    :param authority: for TLS to that robot: certificate of the authority that has signed both certificates, a PEM file
    :param certificate: for TLS: own certificate, a PEM file
    :param key: for TLS: private key of that certificate, a PEM file
    """

    subject: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]")] = "balance"
    learner: str = "careful"
    from_run: Annotated[Path | None, tyro.conf.arg(name="from", metavar="RUN")] = None
    minutes: float = 10.0
    seed: int = 0
    settle_seconds: float = 2.0
    measure_seconds: float = 4.0
    fall_seconds: float = 20.0
    push_seconds: float = 4.0
    change: Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="CHANGE")] = ()
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    resume: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    extended_from: tuple[float, ...] = ()
    compare_frozen: bool = False
    log: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    robot: Annotated[str | None, tyro.conf.arg(metavar="ENDPOINT")] = None
    gone_seconds: Annotated[float, Within(0.0, 1e6, "s")] = GONE_SECONDS
    authority: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    certificate: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    key: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = with_out(COMMAND, sys.argv[1:], {"--run-dir": "--out"})
    for argument in arguments:
        if argument.partition("=")[0].replace("_", "-") in WITHOUT_EFFECT:
            raise ConfigurationError(f"{argument} has no effect in an operation: leave it out")
    options = _parsed(arguments)
    if options.resume is None:
        check_effect(arguments, options.robot is not None)
    if options.log is not None:
        check_new(options.log)
    folder = _begun(options) if options.resume is None else _resumed(options, arguments)
    if folder is None:
        return
    from sarah.cli.logged import logged
    from sarah.training.operate import compare_frozen, operate

    spec = folder.spec()
    print(f"operating for {spec.config.minutes:g} min with learner {spec.learner} into {folder.path}", flush=True)
    if folder.frozen is not None:
        print(f"and then without learning, which takes as long again, into {folder.frozen_path}", flush=True)
    run: Callable[..., SessionResult] = partial(operate, folder, spec)
    if folder.robot is not None:
        run = operate_robot(folder, spec, folder.robot)
    elif options.log is not None:
        run = logged(run, options.log, spec, COMMAND)
    result = watched(run, spec, folder.path)
    frozen = None
    if folder.frozen is not None:
        frozen = watched(partial(compare_frozen, folder, spec, result), spec, folder.path, "without learning ")
    summarise(result, frozen, spec, folder.path)
    say_next(to_see(folder.path), ("test it", ("sarah-eval", folder.path)), to_watch(folder.path))


def _begun(options: OperateOptions) -> SessionFolder:
    """The folder of a new session."""
    from sarah.recorded.folder import new_path
    from sarah.runs.session_folder import SessionFolder

    if present := FORMER_LEARNERS.get(options.learner):
        say_present(COMMAND, f"--learner {options.learner}", "--learner", present)
    recognition = _recognition_of(options)
    if options.robot is not None:
        return _begun_with(options, options.robot, recognition)
    spec = _spec_of(options, recognition)
    _check_learns(options, spec)
    for count in range(len(spec.config.changes) + 1):
        check_engine(spec.config.robot_after(count).engine)
    path = options.out or new_path("operation", f"{spec.learner}-s{spec.seed}")
    folder = SessionFolder.create(path, spec, options.compare_frozen, recognition=_text_of(recognition, spec))
    say_engine(spec.config.robot)
    if Path(options.subject).is_dir() or is_shipped(options.subject):  # numbers have no settings
        of_subject = episode_of(options.subject, None, named_task(options.task)).spec
        say_differences(options.subject, of_subject, spec.config.robot)
    return folder


def _begun_with(options: OperateOptions, address: str, recognition: Recognition | None) -> SessionFolder:
    """The folder of a new session whose robot runs by itself."""
    from sarah.recorded.folder import new_path
    from sarah.runs.session_folder import SessionFolder

    subject = episode_of(options.subject, None, named_task(options.task)).spec
    is_known = Path(options.subject).is_dir() or is_shipped(options.subject)  # numbers have no settings
    learned_with = LearnedWith.of(subject.config) if is_known else None
    SessionSpec(learner=options.learner)  # refuses what is none before anybody is asked
    files = (options.authority, options.certificate, options.key)
    robot, found = robot_found(address, files, options.gone_seconds)
    times = {name: getattr(options, name) for name in ("minutes", "settle_seconds", "measure_seconds", "extended_from")}
    spec = _spec_for(options, _nine(subject), config_for(found, learned_with, **times), recognition)
    path = options.out or new_path("operation", f"{spec.learner}-s{spec.seed}")
    folder = SessionFolder.create(path, spec, robot=robot, recognition=_text_of(recognition, spec))
    print(f"the robot at {address} is {robot.robot}, on {robot.host}")
    return folder


def _resumed(options: OperateOptions, arguments: Sequence[str]) -> SessionFolder | None:
    """The folder of the session to go on with, which may be extended; ``None`` if nothing is left to do."""
    from sarah.runs.session_folder import SessionFolder
    from sarah.training.operate import add_frozen, extend

    assert options.resume is not None
    given = _check_alone(arguments)
    folder = SessionFolder.open(options.resume)
    if folder.robot is not None and options.compare_frozen:
        raise ConfigurationError("--compare-frozen needs a simulated robot: leave it out")
    _check_learns(options, folder.spec())
    there = folder.spec().config.minutes
    minutes = options.minutes if "minutes" in given else there
    if minutes > there:
        check_extendable(folder.path, "--minutes", folder.is_finished)
        extend(folder, minutes)
        print(f"extending {there:g} to {minutes:g} min: the windows so far stay as they are")
    else:
        check_same(folder.path, "session", "minutes", there, minutes)
    if options.compare_frozen and folder.frozen is None:
        add_frozen(folder)
    if folder.is_finished and (folder.frozen is None or folder.frozen.is_finished):
        print(finished_words(folder.path, "--minutes", there))
        return None
    with folder.journal_of(folder.spec()):  # a folder in use is refused before anything is said
        return folder


def _check_learns(options: OperateOptions, spec: SessionSpec) -> None:
    if options.compare_frozen and spec == spec.frozen():
        raise ConfigurationError("--compare-frozen is for a session that learns, and this one does not: leave it out")


def _parsed(arguments: Sequence[str]) -> OperateOptions:
    """Options of the command; a session that it begins with has times of its own."""
    options = parse_episode_options(COMMAND, arguments, OperateOptions(), adapted=settings_in_operation)
    if SESSION.owns(Path(options.subject)):
        usual = dataclasses.replace(OperateOptions(), **times_of_session(Path(options.subject)))
        options = parse_episode_options(COMMAND, arguments, usual, adapted=settings_in_operation)
    assert isinstance(options.episode, OperatedConfig)
    return dataclasses.replace(options, episode=options.episode.as_pushed())


def _check_alone(arguments: Sequence[str]) -> dict[str, str]:
    """Refuse options of a session that goes on, but for its duration and the comparison.

    :return: values of the options that were given, by name
    """
    given = given_options(arguments, "resume", "minutes")
    known = {"--compare-frozen", "--compare_frozen", *given.values()}
    for name, value in given.items():
        known |= {f"--{name}", f"--{name}={value}"}
    if others := [word for word in arguments if word not in known]:
        raise ConfigurationError(f"--resume goes on with a session as it is: leave {shortened(others[0])} out")
    return given


def _recognition_of(options: OperateOptions) -> Recognition | None:
    """What logs teach, for the learner that recognises its robot."""
    if options.learner != "recognise":
        if options.from_run is not None:
            raise ConfigurationError(f"--from is for --learner recognise, not {options.learner}")
        return None
    from sarah.recognition.folder import RecognitionFolder
    from sarah.recognition.recognition import shipped_recognition

    return shipped_recognition() if options.from_run is None else RecognitionFolder.open(options.from_run).recognition()


def _spec_of(options: OperateOptions, recognition: Recognition | None) -> SessionSpec:
    subject = episode_of(options.subject, None, named_task(options.task)).spec
    any_pushed = EpisodeSpec(STEPPING.baseline, 0, STEPPING, options.episode)
    robot = options.applied_to(any_pushed).config
    config = OperationConfig(
        robot=robot if isinstance(robot, PushedConfig) else PushedConfig(**vars(robot), push=NO_PUSH),
        minutes=options.minutes,
        settle_seconds=options.settle_seconds,
        measure_seconds=options.measure_seconds,
        fall_seconds=options.fall_seconds,
        push_seconds=options.push_seconds,
        changes=tuple(map(change_of, options.change)),
        extended_from=options.extended_from,
    )
    return _spec_for(options, _nine(subject), config, recognition)


def _spec_for(
    options: OperateOptions, parameters: Parameters, config: OperationConfig, recognition: Recognition | None
) -> SessionSpec:
    """Specification of a session; one that recognises its robot names the recognition, unless the package ships it."""
    identity = "" if recognition is None or options.from_run is None else recognition.identity
    spec = SessionSpec(parameters, options.learner, options.seed, config, identity)
    if recognition is not None:
        from sarah.training.recognise import check_recognition

        check_recognition(recognition, config, spec.parameters)
    return spec


def _text_of(recognition: Recognition | None, spec: SessionSpec) -> str:
    """Text of the recognition that a specification names; empty if it names none."""
    return recognition.text() if recognition is not None and spec.recognition else ""


def _nine(spec: Any) -> Parameters:
    """P1 to P5 and V1 to V4 of an episode; hips that are locked have zeros."""
    stepping, balance = controller_of(spec.task, spec.parameters, spec.config)
    return (*astuple(stepping), *(BALANCE.baseline if balance is None else astuple(balance)))


def change_of(text: str) -> Change:
    """Read a change, such as ``5: randomisation.actuator_bandwidth=12``.

    :param text: value of the option, a minute and a setting
    :raises ConfigurationError: if it is none
    """
    minute, colon, assignment = text.partition(":")
    key, equals, value = assignment.strip().partition("=")
    try:
        if not colon or not equals:
            raise ValueError
        settings = read_yaml(value)
        for name in reversed(key.strip().replace("-", "_").split(".")):
            settings = {name: settings}
        return Change(number(minute.strip()), settings)
    except ValueError:
        raise ConfigurationError(
            f'change must be a minute and a setting, such as "5: randomisation.actuator_bandwidth=12", not {text!r}'
        ) from None
