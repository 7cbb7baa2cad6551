"""``sarah-train``: learn the controller's parameters."""

from __future__ import annotations

import dataclasses
import re
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.episode_options import DIRECTIONS, given_options, with_given
from sarah.cli.former_names import with_out
from sarah.cli.given_settings import say_differences, settings_of_file, settings_on_stepping
from sarah.cli.going_on import check_extendable, check_same, finished_words
from sarah.cli.interruption import interruptible
from sarah.cli.next_steps import say_next, to_see, to_watch
from sarah.cli.options import as_command, named_task, parse_options, pushed_words, say_engine
from sarah.cli.train_text import say_learned
from sarah.cli.training_defaults import default_training
from sarah.episode.push import PushedConfig
from sarah.episode.reward import equation_2, frequency_hint
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig, load_task
from sarah.errors import ConfigurationError, RunFolderError, TaskError
from sarah.files import quoted
from sarah.robot.description import describe_robot
from sarah.robot.scale import Scale
from sarah.runs.agent_names import unknown_option
from sarah.runs.agent_settings import NAFSettings, settings_of
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import first_difference
from sarah.runs.recorded_task import RecordedTask
from sarah.simulation.engines import check_engine

if TYPE_CHECKING:
    from sarah.episode.workers import Workers
    from sarah.runs.run_folder import RunFolder
    from sarah.training.train import Learned

COMMAND = "sarah-train"
OFFLINE = "--offline"
"""Option that makes the command learn from logs; the others are then those of :mod:`sarah.cli.offline`."""


@dataclass(frozen=True)
class TrainOptions:
    """Learn the parameters of the pattern generator or of the hip law, with one action of the agent per episode.

    Settings come from four places, and later ones win: the defaults below, the run folder of --from, the
    file of --config, and the command line. The settings of the agent depend on --algo and those of the
    episodes on --task: give both before --help. The training writes a run folder with the learned parameters
    in parameters.json, all episodes in episodes.csv, the agent in model.zip, and the curves that TensorBoard shows.

    Most robots survive the paper's pushes without learning. So by default --task balance pushes harder, in shorter
    episodes. The paper's settings, for its robot of 30 kg, are:
    --episode.push.newtons 0 100 --episode.push.sagittal-share 0 --episode.time-limit 30

    A file of --config that names no others has these too, unless --from is given.

    With --offline it learns from logs instead, without simulation: see sarah-train --offline --help.

    :param training: settings of the training
    :param out: run folder to write, new or empty; by default a new one, runs/<task>/<algo>-s<seed>
    :param config: YAML file of settings, like the config.yaml of any run folder
    :param resume: run folder of an interrupted training to continue with its settings; the result is the same as
        without the interruption. A finished training continues if --episodes is larger than its budget
    :param from_run: run folder of a First Training, for --task balance: its P1 to P5 and all settings of its episodes
        are used. Push and time limit are this command's defaults, unless --config names others
    :param workers: number of processes on this machine that simulate; with 0, this process does. It changes no result
    :param scheduler: address of a Dask scheduler whose workers simulate instead, such as tcp://10.0.0.1:8786
    """

    training: Annotated[TrainingConfig, tyro.conf.arg(name="")] = TrainingConfig()
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    config: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    resume: Annotated[Path | None, tyro.conf.arg(metavar="RUN")] = None
    from_run: Annotated[Path | None, tyro.conf.arg(name="from", metavar="RUN")] = None
    workers: int = 0
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = [re.sub(r"^--simulations(?==|$)", "--episodes", argument) for argument in sys.argv[1:]]  # an alias
    if arguments and not arguments[0].startswith("-"):  # other commands begin with what they look at
        raise ConfigurationError(f"{arguments[0]!r} is no option: a task is given as --task {arguments[0]}")
    if any(argument.partition("=")[0] == OFFLINE for argument in arguments):
        from sarah.cli.offline import train_offline

        train_offline(arguments)
        return
    arguments = with_out(COMMAND, arguments, {"--run-dir": "--out"})
    options = parse_options(TrainOptions, COMMAND, arguments, _defaults(arguments))
    config = options.training
    if options.from_run is not None and config.task is not BALANCE:
        same = f": to train again with its settings, say --config {quoted(options.from_run / 'config.yaml')}"
        raise ConfigurationError(f"--from is for --task {BALANCE.name}, not {config.task.reference!r}{same}")
    describe_robot(config.episode.dimensions)  # a bad dimension is refused before anything is written
    from sarah.episode.trial import try_task
    from sarah.episode.workers import Workers
    from sarah.recorded.folder import new_path
    from sarah.runs.run_folder import RunFolder
    from sarah.training.learners import check_device

    check_device(config.agent)
    check_engine(config.episode.engine)
    if config.pictures:
        from sarah.simulation.renderer import check_renderer

        check_renderer()
    if options.resume is not None:
        run = _resumed(options.resume, options, config)
        if run.is_finished and config.episodes == run.config().episodes:
            print(finished_words(options.resume, "--episodes", config.episodes))
            return
        with run.journal_of(run.config()):  # what cannot go on is refused before workers start
            pass
    elif options.out is not None:
        RunFolder(options.out).check_new()

    try_task(config.task, config.episode)
    with Workers(options.workers, options.scheduler) as workers:
        if options.resume is not None:
            run = RunFolder.open(options.resume, unfinished=True, task=config.task)
            if run.is_finished:  # only now that somebody can simulate
                config = _extended(run, config)
            doing, known = "resuming the training of", _known_words(run)
        else:
            run = RunFolder.create(options.out or new_path(config.task.name, f"{config.algo}-s{config.seed}"), config)
            doing, known = "training", ""
        say_engine(config.episode)
        pushed = f", {pushed_words(config.episode)}" if isinstance(config.episode, PushedConfig) else ""
        what = f"{config.algo} on {config.task.name}{pushed}"
        print(f"{doing} {what}: {config.episodes} episodes{known} into {run.path}", flush=True)
        if config.episode.scale != Scale():
            size = f"motors and other settings go with {config.episode.scale.words()}"
            print(f"{size}: sarah-describe {quoted(run.path)} lists them", flush=True)
        if config.task.reward is equation_2 and (hint := frequency_hint(config.episode)):
            print(hint, file=sys.stderr)
        if options.from_run is not None and isinstance(config.episode, BalanceConfig):
            say_differences(options.from_run, config.episode)
        named = given_options(arguments, "task") if config.task.file is not None else {}
        learned = _learned(config, run, workers, " ".join(f" --task {quoted(task)}" for task in named.values()))
    say_learned(config, learned, run.path)
    typed = [word for value in named.values() for word in ("--task", value)]
    say_next(to_see(run.path, *typed), ("test it", ("sarah-eval", run.path, *typed)), to_watch(run.path))


def _resumed(path: Path, options: TrainOptions, config: TrainingConfig) -> RunFolder:
    """Open the run folder to go on with."""
    from sarah.runs.run_folder import RunFolder

    run = RunFolder.open(path, unfinished=True, task=config.task)
    if options.out is not None or options.config is not None or options.from_run is not None:
        raise ConfigurationError("--resume goes on with a training as it is: leave --out, --config and --from out")
    there = dataclasses.replace(run.config(), pictures=config.pictures)  # they change no result
    if config.episodes > there.episodes and config.extended_from == there.extended_from:
        check_extendable(path, "--episodes", run.is_finished)
        config = dataclasses.replace(config, episodes=there.episodes)
    if difference := first_difference(config, there):
        key, given, recorded = difference
        check_same(path, "training", key, recorded, given)
    return run


def _known_words(run: RunFolder) -> str:
    """Words about how many episodes it has, unless their table is damaged: a resumed training writes it anew."""
    with suppress(RunFolderError):
        return f", of which episodes.csv has {sum(1 for _ in run.episodes())},"
    return ""


def _extended(run: RunFolder, config: TrainingConfig) -> TrainingConfig:
    """Extend a finished training to a larger budget, and say what that means."""
    before = run.config()
    extended = dataclasses.replace(before.extended_to(config.episodes), pictures=config.pictures)
    with run.journal_of(before):  # of two at once, one extends it
        run.extend(extended)
    added = extended.episodes - before.episodes
    print(
        f"extending {before.episodes} to {extended.episodes} episodes: what changes in the course of a training, such "
        f"as NAF's exploration, goes on as in the last {added} of {extended.episodes} episodes"
    )
    return extended


def _learned(config: TrainingConfig, run: RunFolder, workers: Workers, task: str) -> Learned:
    """Train; if the training stops early, the message says how to go on, with the option of a file's task."""
    from sarah.training.train import train

    go_on = f"go on with {COMMAND} --resume {quoted(run.path)}{task}"
    with interruptible(COMMAND, "episode", go_on) as interrupted:
        try:
            return train(config, run, workers, True, interrupted)
        except TaskError as error:
            raise TaskError(f"{error}; correct the file, and train into another folder than {run.path}") from error


def _defaults(arguments: Sequence[str]) -> TrainOptions:
    """Default options with the changes of --config, --from and --agent.preset, for the task, algorithm and engine.

    The parser takes the names of further options from these defaults.
    """
    names = ("config", "resume", "from", "task", "algo", "agent.preset", "engine", "episode.engine")
    given = given_options(arguments, *names, *DIRECTIONS)
    if "resume" in given:
        return _resumed_defaults(Path(given["resume"]), given)
    task = named_task(given.get("task"))
    file = Path(given["config"]) if "config" in given else None
    training = default_training(task or STEPPING) if file is None else settings_of_file(file, task, arguments)
    training = _with_agent(training, given.get("algo"), given.get("agent.preset"))
    _check_agent_options(arguments, training)
    first = given.get("from") if training.task is BALANCE else None
    episode = training.episode if first is None else settings_on_stepping(Path(first), file, arguments)
    is_recorded = first is not None or file is not None
    episode = with_given(episode, arguments, given, is_recorded, file is None and training.task is BALANCE)
    return TrainOptions(dataclasses.replace(training, episode=episode))


def _resumed_defaults(path: Path, given: Mapping[str, str]) -> TrainOptions:
    """Options of the training to go on with; other settings than its own would need other options."""
    from sarah.runs.run_folder import RunFolder

    task, training = None, RunFolder.open(path, unfinished=True).config()
    if "task" in given:
        task = load_task(given["task"])
        if task.file is None:
            check_same(path, "training", "task", training.task.reference, task.reference)
        training = RunFolder.open(path, unfinished=True, task=task).config()
    if isinstance(training.task, RecordedTask):
        raise ConfigurationError(f"--resume {path}: its task is that of a file: add --task {training.task.reference}")
    engine = given.get("engine", given.get("episode.engine", training.episode.engine))
    check_same(path, "training", "algo", training.algo, given.get("algo", training.algo))
    check_same(path, "training", "episode.engine", training.episode.engine, engine)
    return TrainOptions(training)


def _with_agent(training: TrainingConfig, algo: str | None, preset: str | None) -> TrainingConfig:
    """Training with another algorithm and its default settings, or with the settings of another preset of NAF."""
    if algo is not None and algo != training.algo:
        training = dataclasses.replace(training, algo=algo, agent=settings_of(algo)())
    if preset is not None and isinstance(training.agent, NAFSettings) and preset != training.agent.preset:
        training = dataclasses.replace(training, agent=training.agent.with_preset(preset))
    return training


def _check_agent_options(arguments: Sequence[str], training: TrainingConfig) -> None:
    """Refuse ``--agent.…`` options of settings that the algorithm has not."""
    for argument in arguments:
        if argument.startswith("--agent.") and (message := unknown_option(training.algo, argument.partition("=")[0])):
            raise ConfigurationError(message)
