"""``sarah-train``: learn the pattern generator's parameters."""

from __future__ import annotations

import dataclasses
import shlex
import signal
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.interruption import Interruption
from sarah.cli.options import (
    check_episode_options,
    episode_of,
    given_options,
    parse_options,
    run_command,
    say_engine,
    with_engine,
)
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING, TASKS
from sarah.errors import ConfigurationError, RunFolderError, SarahError, TrainingInterruptedError
from sarah.runs.agent_settings import NAFSettings, settings_of
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import first_difference, read_config

if TYPE_CHECKING:
    from sarah.episode.workers import Workers
    from sarah.runs.run_folder import RunFolder
    from sarah.training.train import Learned

COMMAND = "sarah-train"


@dataclass(frozen=True)
class TrainOptions:
    """Learn the pattern generator's parameters, one episode per action of the agent.

    Settings come from the defaults below, then from the file of --config, then from the run of --from, then from the
    command line. Those of the agent are of the algorithm that --algo names, those of the episodes of --task: give both
    before --help. The run folder holds the learned parameters (parameters.json), every episode (episodes.csv), the
    agent (model.zip) and what TensorBoard shows.

    :param training: what to train
    :param engine: of the physics, ``pybullet`` or ``mujoco``: short for --episode.engine
    :param run_dir: folder of the run, new or empty; by default a new one, runs/<task>/<algo>-s<seed>
    :param config: YAML file of settings, like the config.yaml of any run
    :param resume: go on with this run folder's training, as if it had not been interrupted; its settings
        are used
    :param from_run: balance with P1 to P5 and the robot of this First Training's run folder
    :param pictures: number of episodes after which what would be recommended is drawn for TensorBoard: a gait cycle,
        and a video of 3 s. Each costs some seconds, and changes no result; 0 draws none
    :param workers: processes that simulate, on this machine; with none, this process does. They change no result
    :param scheduler: address of a Dask scheduler whose workers simulate instead, such as tcp://10.0.0.1:8786
    """

    training: Annotated[TrainingConfig, tyro.conf.arg(name="")] = TrainingConfig()
    engine: Annotated[str | None, tyro.conf.arg(metavar="STR")] = None
    run_dir: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    config: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    resume: Annotated[Path | None, tyro.conf.arg(metavar="RUN")] = None
    from_run: Annotated[Path | None, tyro.conf.arg(name="from", metavar="RUN")] = None
    pictures: int = 0
    workers: int = 0
    scheduler: Annotated[str | None, tyro.conf.arg(metavar="ADDRESS")] = None


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _train)


def _train(arguments: Sequence[str]) -> None:
    arguments = [argument.replace("--simulations", "--episodes") for argument in arguments]  # its former name
    options = parse_options(TrainOptions, COMMAND, arguments, _defaults(arguments))
    config = options.training
    config = dataclasses.replace(config, episode=with_engine(config.episode, options.engine))
    if options.from_run is not None and config.task != BALANCE.name:
        raise ConfigurationError(f"--from is for --task {BALANCE.name}, not {config.task!r}")
    from sarah.robot.description import describe_robot

    describe_robot(config.episode.dimensions)  # a bad dimension is refused before anything is written
    from sarah.episode.workers import Workers
    from sarah.runs.run_folder import RunFolder, new_run_path
    from sarah.simulation.engines import check_engine
    from sarah.training.learners import check_device

    check_device(config.agent)
    check_engine(config.episode.engine)
    if options.pictures:
        from sarah.simulation.renderer import check_renderer

        check_renderer()
    if options.resume is not None and _resumed(options.resume, options).is_finished:
        print(f"{options.resume} is finished: there is nothing to resume")
        return

    with Workers(options.workers, options.scheduler) as workers:
        if options.resume is not None:
            run = RunFolder.resumable(options.resume)
        else:
            run = RunFolder.create(options.run_dir or new_run_path(config.task, config.algo, config.seed), config)
        say_engine(config.episode, options.engine)
        print(f"training {config.algo} on {config.task}: {config.episodes} episodes into {run.path}", flush=True)
        learned = _learned(config, run, workers, options.pictures)
    _summarise(config.task, learned, run.path)


def _resumed(path: Path, options: TrainOptions) -> RunFolder:
    """The run folder to go on with; warns if versions are not what they were."""
    from sarah.runs.run_folder import RunFolder
    from sarah.versions import versions

    run = RunFolder.resumable(path)
    if options.run_dir is not None or options.config is not None or options.from_run is not None:
        raise ConfigurationError("--resume goes on with a run as it is: leave --run-dir, --config and --from out")
    difference = first_difference(options.training, run.config())
    if difference is not None:
        key, given, there = difference
        raise ConfigurationError(f"--resume {path}: {key} is {there!r} in this run, not {given!r}: leave it out")
    before = run.versions()
    for name, version in versions().items():
        if before.get(name) != version:
            print(
                f"{COMMAND}: warning: {path} was begun with {name} {before.get(name)}, and this is {version}: "
                "it may not go on as it would have",
                file=sys.stderr,
            )
    return run


def _learned(config: TrainingConfig, run: RunFolder, workers: Workers, picture_interval: int) -> Learned:
    """Train; whatever stops it, the message says how to go on."""
    from sarah.training.train import train

    go_on = f"go on with {COMMAND} --resume {shlex.quote(str(run.path))}"
    with Interruption(COMMAND) as interruption:
        try:
            return train(config, run, workers, True, interruption.came, picture_interval)
        except (TrainingInterruptedError, KeyboardInterrupt):
            print(f"\n{COMMAND}: interrupted; {go_on}", file=sys.stderr)
            raise SystemExit(128 + (interruption.signal or signal.SIGINT)) from None
        except (SarahError, OSError) as error:
            raise RunFolderError(f"{error}; what is finished is kept, {go_on}") from error


def _defaults(arguments: Sequence[str]) -> TrainOptions:
    """The defaults, as --config, --from and --agent.preset change them, of the kinds that task, algorithm, engine take.

    The parser of the command line knows settings by their default.
    """
    names = ("config", "resume", "from", "task", "algo", "agent.preset", "engine", "episode.engine")
    given = given_options(arguments, *names)
    if "resume" in given:
        from sarah.runs.run_folder import RunFolder

        return TrainOptions(RunFolder.resumable(Path(given["resume"])).config())
    training = read_config(TrainingConfig, Path(given["config"])) if "config" in given else TrainingConfig()
    training = _with_agent(training, given.get("algo"), given.get("agent.preset"))
    task = given.get("task", training.task)
    if task not in TASKS:  # the real parser's options report it
        return TrainOptions(training)
    episode = episode_of(task, training.episode, given)
    check_episode_options(arguments, episode)
    if "from" in given and task == BALANCE.name:
        episode = _on_learned_stepping(Path(given["from"]), episode)
    return TrainOptions(dataclasses.replace(training, task=task, episode=episode))


def _with_agent(training: TrainingConfig, algo: str | None, preset: str | None) -> TrainingConfig:
    """A training by another algorithm, with its default settings, or with what another preset of NAF decides."""
    if algo is not None and algo != training.algo:
        training = dataclasses.replace(training, algo=algo, agent=settings_of(algo)())
    if preset is not None and isinstance(training.agent, NAFSettings) and preset != training.agent.preset:
        training = dataclasses.replace(training, agent=training.agent.with_preset(preset))
    return training


def _on_learned_stepping(path: Path, episode: EpisodeConfig) -> EpisodeConfig:
    """Episode settings with what a First Training learned, and the robot that it learned on."""
    from sarah.runs.run_folder import RunFolder

    run = RunFolder.open(path)
    learned = run.config()
    if learned.task != STEPPING.name:
        raise ConfigurationError(
            f"{path} learned {learned.task!r}, and --from needs a run that learned {STEPPING.name!r}"
        )
    return BALANCE.config_of(episode, stepping=run.parameters(), dimensions=learned.episode.dimensions)


def _summarise(task: str, learned: Learned, path: Path) -> None:
    evaluation, baseline = learned.evaluation, learned.baseline
    named = zip(TASKS[task].parameter_names, learned.parameters, strict=True)
    print("\nlearned     " + ", ".join(f"{name} = {value:.2f}" for name, value in named))
    score = f"{evaluation.median('score'):.3f}"
    print(f"score       {score} (median of {evaluation.episodes} unseen seeds; 1 is the ceiling)")
    print(f"steps       {evaluation.mean('steps_per_second'):.2f} per second")
    compared = f", {baseline.survival_rate:.0%} with V = 0" if baseline else ""
    print(f"survival    {evaluation.survival_rate:.0%}{compared}")
    shifts, lifts = evaluation.mean("shifts_by_sensors"), evaluation.mean("lifts_by_sensors")
    clearance = 1000 * evaluation.mean("sole_clearance")
    print(f"by sensors  {shifts:.0%} of shifts, {lifts:.0%} of lifts; sole clearance {clearance:.0f} mm")
    if learned.diverged:
        print(f"diverged    {learned.diverged} episodes: no number came back")
    if not evaluation.is_gait:
        print("            not a gait: it steps to a clock, or does not lift its feet")
    if baseline is not None and evaluation.chatters(baseline):
        print("            it chatters: no real robot could do that")
    print(f"run folder  {path}")
