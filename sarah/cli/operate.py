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
from sarah.cli.interruption import interruptible
from sarah.cli.next_steps import say_next, to_see, to_watch
from sarah.cli.operated import OperatedConfig, say_differences, settings_in_operation, times_of_session
from sarah.cli.options import as_command, named_task, say_engine
from sarah.cli.subjects import episode_of, is_shipped
from sarah.episode.push import NO_PUSH, PushedConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.episode.tasks import BALANCE, STEPPING
from sarah.errors import ConfigurationError, shortened
from sarah.files import quoted
from sarah.formats import read_yaml
from sarah.logs.chunk_file import check_new
from sarah.number import number
from sarah.operation.settings import PARAMETERS, Change, OperationConfig, Parameters
from sarah.runs.kinds import SESSION
from sarah.runs.session import FORMER_LEARNERS, SessionSpec
from sarah.simulation.engines import check_engine

if TYPE_CHECKING:
    from sarah.operation.window import Window
    from sarah.recognition.recognition import Recognition
    from sarah.runs.session_folder import SessionFolder
    from sarah.training.operate import SessionResult

COMMAND = "sarah-operate"
WITHOUT_EFFECT = ("--episode.time-limit", "--episode.reward-form", "--episode.push.at-seconds")
"""Options of episodes that an operation, which goes on and is pushed again and again, does not know."""


@dataclass(frozen=True)
class OperateOptions(EpisodeOptions):
    """Let the robot run in windows, and improve its nine parameters between them, using only its own sensors.

    Give --episode.… for what differs from the robot of the training, such as --episode.randomisation.actuator-bandwidth
    12 or --episode.payload 5, and --change for what changes during the session.

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


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = with_out(COMMAND, sys.argv[1:], {"--run-dir": "--out"})
    for argument in arguments:
        if argument.partition("=")[0].replace("_", "-") in WITHOUT_EFFECT:
            raise ConfigurationError(f"{argument} has no effect in an operation: leave it out")
    options = _parsed(arguments)
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
    run = partial(operate, folder, spec)
    result = _watched(run if options.log is None else logged(run, options.log, spec, COMMAND), spec, folder.path)
    frozen = None
    if folder.frozen is not None:
        frozen = _watched(partial(compare_frozen, folder, spec, result), spec, folder.path, "without learning ")
    _summarise(result, frozen, spec, folder.path)
    say_next(to_see(folder.path), ("test it", ("sarah-eval", folder.path)), to_watch(folder.path))


def _begun(options: OperateOptions) -> SessionFolder:
    """The folder of a new session."""
    from sarah.recorded.folder import new_path
    from sarah.runs.session_folder import SessionFolder

    if present := FORMER_LEARNERS.get(options.learner):
        say_present(COMMAND, f"--learner {options.learner}", "--learner", present)
    recognition = _recognition_of(options)
    spec = _spec_of(options, recognition)
    _check_learns(options, spec)
    for count in range(len(spec.config.changes) + 1):
        check_engine(spec.config.robot_after(count).engine)
    path = options.out or new_path("operation", f"{spec.learner}-s{spec.seed}")
    folder = SessionFolder.create(path, spec, options.compare_frozen, recognition.text() if spec.recognition else "")
    say_engine(spec.config.robot)
    if Path(options.subject).is_dir() or is_shipped(options.subject):  # numbers have no settings
        of_subject = episode_of(options.subject, None, named_task(options.task)).spec
        say_differences(options.subject, of_subject, spec.config.robot)
    return folder


def _resumed(options: OperateOptions, arguments: Sequence[str]) -> SessionFolder | None:
    """The folder of the session to go on with, which may be extended; ``None`` if nothing is left to do."""
    from sarah.runs.session_folder import SessionFolder
    from sarah.training.operate import add_frozen, extend

    assert options.resume is not None
    given = _check_alone(arguments)
    folder = SessionFolder.open(options.resume)
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
    identity = "" if recognition is None or options.from_run is None else recognition.identity
    spec = SessionSpec(_nine(subject), options.learner, options.seed, config, identity)
    if recognition is not None:
        from sarah.training.recognise import check_recognition

        check_recognition(recognition, config, spec.parameters)
    return spec


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


def _watched(
    run: Callable[[Callable[[Window], None], Callable[[], bool]], SessionResult],
    spec: SessionSpec,
    path: Path,
    title: str = "",
) -> SessionResult:
    """Run a session with a progress bar; if it stops early, the message says how to go on.

    :param run: function that runs it, of one that is called with every window and one that says whether to stop
    :param spec: specification of the session
    :param path: path of its folder
    :param title: words before the bar
    """
    from tqdm import tqdm

    go_on = f"go on with {COMMAND} --resume {quoted(path)}"
    falls, seconds = 0, 60.0 * spec.config.minutes
    bar = tqdm(total=seconds, desc=title, disable=None, bar_format="{l_bar}{bar}| {n:.0f} of {total:.0f} s{postfix}")

    def show(window: Window) -> None:
        nonlocal falls
        falls += window.fell
        bar.set_postfix(window=window.index, score=f"{window.score:.2f}", falls=falls, changes=window.changes)
        bar.update(min(window.end, seconds) - bar.n)

    with bar, interruptible(COMMAND, "window", go_on) as interrupted:
        return run(show, interrupted)


def _summarise(result: SessionResult, frozen: SessionResult | None, spec: SessionSpec, path: Path) -> None:
    named = zip((parameter.name for parameter in PARAMETERS), result.parameters, strict=True)
    print("\nleft with   " + ", ".join(f"{name} = {value:.2f}" for name, value in named))
    print(f"score       {scores_of(result)}")
    print(f"falls       {result.falls} in {len(result.windows)} windows")
    if frozen is not None:
        print(f"frozen      {scores_of(frozen)}; falls: {frozen.falls} in {len(frozen.windows)} windows")
    for change in spec.config.changes[result.windows[-1].changes :]:
        print(f"no change   at minute {change.minute:g}: no window began after it")
    print(f"folder      {path}")


def scores_of(result: SessionResult) -> str:
    """Mean score of a session, and how it went from its first fifth to its last.

    :param result: result of the session
    """
    scores = [window.score for window in result.windows]
    fifth = max(1, len(scores) // 5)
    first, last = sum(scores[:fifth]) / fifth, sum(scores[-fifth:]) / fifth
    windows = "window" if fifth == 1 else f"{fifth} windows"
    return f"{result.mean_score():.3f}: {first:.3f} in the first {windows}, {last:.3f} in the last"
