"""``sarah-operate``: let the robot run on, and renew its parameters from its own experience."""

from __future__ import annotations

import dataclasses
import signal
import sys
from collections.abc import Sequence
from dataclasses import astuple, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import tyro

from sarah.cli.episode_options import EpisodeOptions, given_options, parse_episode_options
from sarah.cli.former_names import with_out
from sarah.cli.interruption import Interruption
from sarah.cli.next_steps import say_next, to_see, to_test, to_watch
from sarah.cli.options import named_task, run_command, say_engine
from sarah.cli.subjects import episode_of
from sarah.episode.push import NOBODY, PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, controller_of
from sarah.errors import (
    ConfigurationError,
    ResumeError,
    RunFolderError,
    SarahError,
    TrainingInterruptedError,
    shortened,
)
from sarah.files import quoted
from sarah.formats import read_yaml
from sarah.number import number
from sarah.operation.settings import SOFT_PUSHES, Change, OperationConfig, Parameters
from sarah.sessions import is_session

if TYPE_CHECKING:
    from sarah.operation.window import Window
    from sarah.sessions.session import SessionResult, SessionSpec
    from sarah.sessions.session_folder import SessionFolder

COMMAND = "sarah-operate"
WITHOUT_EFFECT = ("--episode.time-limit", "--episode.reward-form", "--episode.push.at-seconds")
"""Options of episodes that an operation, which goes on and is pushed again and again, does not know."""


@dataclass(frozen=True)
class OperateOptions(EpisodeOptions):
    """Let the robot run on in windows, and renew its nine parameters between them, from what its own sensors tell.

    Describe how the robot differs from the one that its parameters were learned on by --episode.…, such as
    --episode.randomisation.actuator-bandwidth 12 or --episode.payload 5, and what changes on the way by --change.

    :param subject: run folder of a training or a session, numbers separated by commas (P1 to P5, V1 to V4, or all
        nine), or the name of shipped parameters: what the robot begins with
    :param learner: ``none``, ``gp`` (careful), ``naf``, ``cma-es`` or ``random``
    :param minutes: duration of the operation, in min
    :param seed: seed of robot, world, noise, pushes and learner
    :param settle_seconds: time that a window gives new parameters to settle, in s
    :param measure_seconds: time that a window measures, in s
    :param fall_seconds: time that a fall costs, in s
    :param push_seconds: time from a push to the next, in s; --episode.push.newtons sets their force
    :param change: what changes, and when, such as "5: randomisation.actuator_bandwidth=12" at minute 5; once for each
        change, in the order of time
    :param out: folder to write, new or empty; by default a new one, runs/operation/<learner>-s<seed>
    :param resume: folder of an interrupted session to go on with, as it is
    """

    subject: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]")] = "balance"
    learner: str = "gp"
    minutes: float = 10.0
    seed: int = 0
    settle_seconds: float = 2.0
    measure_seconds: float = 4.0
    fall_seconds: float = 20.0
    push_seconds: float = 4.0
    change: Annotated[tuple[str, ...], tyro.conf.UseAppendAction, tyro.conf.arg(metavar="CHANGE")] = ()
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    resume: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _operate)


def _operate(arguments: Sequence[str]) -> None:
    arguments = with_out(COMMAND, arguments, {"--run-dir": "--out"})
    for argument in arguments:
        if argument.partition("=")[0].replace("_", "-") in WITHOUT_EFFECT:
            raise ConfigurationError(f"{argument} has no effect in an operation: leave it out")
    options = parse_episode_options(COMMAND, arguments, OperateOptions(), adapted=_of_operation)
    from sarah.runs.run_folder import new_run_path
    from sarah.sessions.session_folder import SessionFolder
    from sarah.simulation.engines import check_engine

    if options.resume is not None:
        _check_alone(arguments)
        folder = SessionFolder.open(options.resume)
        spec = folder.spec()
        if folder.is_finished:
            print(f"{options.resume} is finished: its parameters are in {folder.path / 'parameters.json'}")
            return
    else:
        spec = _spec_of(options)
        for count in range(len(spec.config.changes) + 1):
            check_engine(spec.config.robot_after(count).engine)
        path = options.out or new_run_path("operation", spec.learner, spec.seed)
        folder = SessionFolder.create(path, spec)
        say_engine(spec.config.robot, options.engine)
    print(f"operating for {spec.config.minutes:g} min with learner {spec.learner} into {folder.path}", flush=True)
    _summarise(_watched(folder, spec), spec, folder.path)
    say_next(to_see(folder.path), to_test(folder.path), to_watch(folder.path))


def _of_operation(config: EpisodeConfig, subject: str | None) -> PushedConfig:
    """Settings of a robot in operation: those of the subject, with soft pushes, unless they are a session's own."""
    shared = {item.name: getattr(config, item.name) for item in dataclasses.fields(EpisodeConfig)}
    is_own = subject is not None and is_session(Path(subject))
    push = config.push if is_own and isinstance(config, PushedConfig) else config.scale.scaled(SOFT_PUSHES)
    return PushedConfig(**shared, push=push)


def _check_alone(arguments: Sequence[str]) -> None:
    given = given_options(arguments, "resume")
    words = [argument for argument in arguments if argument not in ("--resume", given["resume"])]
    if others := [word for word in words if not word.startswith("--resume=")]:
        raise ConfigurationError(f"--resume goes on with a session as it is: leave {shortened(others[0])} out")


def _spec_of(options: OperateOptions) -> SessionSpec:
    from sarah.sessions.session import SessionSpec

    subject = episode_of(options.subject, None, named_task(options.task)).spec
    any_pushed = EpisodeSpec(STEPPING.baseline, 0, STEPPING, options.episode)
    robot = options.applied_to(any_pushed).config
    config = OperationConfig(
        robot=robot if isinstance(robot, PushedConfig) else PushedConfig(**vars(robot), push=NOBODY),
        minutes=options.minutes,
        settle_seconds=options.settle_seconds,
        measure_seconds=options.measure_seconds,
        fall_seconds=options.fall_seconds,
        push_seconds=options.push_seconds,
        changes=tuple(map(change_of, options.change)),
    )
    return SessionSpec(_nine(subject), options.learner, options.seed, config)


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


def _watched(folder: SessionFolder, spec: SessionSpec) -> SessionResult:
    """Run the session with a progress bar; if it stops early, the message says how to go on."""
    from tqdm import tqdm

    from sarah.sessions.operate import operate

    go_on = f"go on with {COMMAND} --resume {quoted(folder.path)}"
    falls, seconds = 0, 60.0 * spec.config.minutes
    bar = tqdm(total=seconds, disable=None, bar_format="{l_bar}{bar}| {n:.0f} of {total:.0f} s{postfix}")

    def show(window: Window) -> None:
        nonlocal falls
        falls += window.fell
        bar.set_postfix(window=window.index, score=f"{window.score:.2f}", falls=falls, changes=window.changes)
        bar.update(min(window.end, seconds) - bar.n)

    with bar, Interruption(COMMAND, "window") as interruption:
        try:
            return operate(folder, spec, show, interruption.came)
        except (TrainingInterruptedError, KeyboardInterrupt):
            print(f"\n{COMMAND}: interrupted; {go_on}", file=sys.stderr)
            raise SystemExit(128 + (interruption.signal or signal.SIGINT)) from None
        except ResumeError:
            raise
        except (SarahError, OSError) as error:
            raise RunFolderError(f"{error}; finished windows are kept, {go_on}") from error


def _summarise(result: SessionResult, spec: SessionSpec, path: Path) -> None:
    from sarah.operation.settings import PARAMETERS

    named = zip((parameter.name for parameter in PARAMETERS), result.parameters, strict=True)
    print("\nleft with   " + ", ".join(f"{name} = {value:.2f}" for name, value in named))
    scores = [window.score for window in result.windows]
    fifth = max(1, len(scores) // 5)
    first, last = sum(scores[:fifth]) / fifth, sum(scores[-fifth:]) / fifth
    windows = "window" if fifth == 1 else f"{fifth} windows"
    print(f"score       {result.mean_score():.3f}: {first:.3f} in the first {windows}, {last:.3f} in the last")
    print(f"falls       {result.falls} in {len(result.windows)} windows")
    for change in spec.config.changes[result.windows[-1].changes :]:
        print(f"no change   at minute {change.minute:g}: no window began after it")
    print(f"folder      {path}")
