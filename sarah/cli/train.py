"""``sarah-train``: learn the pattern generator's parameters."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.options import parse_options, run_command
from sarah.config import TrainingConfig, read_config

if TYPE_CHECKING:
    from sarah.evaluation import Evaluation

COMMAND = "sarah-train"


@dataclass(frozen=True)
class TrainOptions:
    """Learn the pattern generator's parameters, one simulation per action of the agent.

    Settings come from the defaults below, then from the file of --config, then from the command line. The run
    folder holds the learned parameters (parameters.json), every simulation (episodes.csv), the agent (model.zip)
    and what TensorBoard shows.

    :param training: what to train
    :param run_dir: folder of the run, new or empty; by default a new one, runs/<task>/<algo>-s<seed>
    :param config: YAML file of settings, like the config.yaml of any run
    """

    training: Annotated[TrainingConfig, tyro.conf.arg(name="")] = TrainingConfig()
    run_dir: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None
    config: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None


def main() -> None:
    """Run the command with the arguments of the process."""
    run_command(COMMAND, _train)


def _train(arguments: Sequence[str]) -> None:
    options = parse_options(TrainOptions, COMMAND, arguments, _from_file(arguments))
    config = options.training
    from sarah.description import describe_robot

    describe_robot(config.episode.dimensions)  # a bad dimension is refused before anything is written
    from sarah.runs import RunFolder, new_run_path

    run = RunFolder.create(options.run_dir or new_run_path(config.task, config.algo, config.seed), config)
    print(f"training {config.algo} on {config.task}: {config.simulations} simulations into {run.path}", flush=True)
    from sarah.training import train

    parameters, evaluation = train(config, run, progress_bar=True)
    _summarise(parameters, evaluation, run.path)


def _from_file(arguments: Sequence[str]) -> TrainOptions:
    """The defaults, as --config changes them."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False, exit_on_error=False)
    parser.add_argument("--config", type=Path)
    try:
        path = parser.parse_known_args(arguments)[0].config
    except argparse.ArgumentError:  # a --config without a file, which the real parser reports
        path = None
    return TrainOptions() if path is None else TrainOptions(read_config(TrainingConfig, path))


def _summarise(parameters: tuple[float, ...], evaluation: Evaluation, path: Path) -> None:
    from sarah.pattern_generator import PARAMETER_NAMES

    learned = ", ".join(f"{name} = {value:.2f}" for name, value in zip(PARAMETER_NAMES, parameters, strict=True))
    print(f"\nlearned     {learned}")
    print(f"score       {evaluation.score_median:.3f} (median of {evaluation.episodes} unseen seeds; 1 is the ceiling)")
    print(f"steps       {evaluation.steps_per_second_mean:.2f} per second, {evaluation.survival_rate:.0%} survive 30 s")
    shares = f"{evaluation.event_driven_shift_mean:.0%} of shifts, {evaluation.event_driven_lift_mean:.0%} of lifts"
    print(f"by sensors  {shares}; sole clearance {1000 * evaluation.sole_clearance_mean:.0f} mm")
    if not evaluation.is_gait:
        print("            not a gait: it steps to a clock, or does not lift its feet")
    print(f"run folder  {path}")
