"""What ``sarah-train`` prints in the end."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from sarah.episode.tasks import BALANCE
from sarah.runs.config import TrainingConfig

if TYPE_CHECKING:
    from sarah.training.train import Learned


def say_learned(config: TrainingConfig, learned: Learned, path: Path) -> None:
    """Print what a training has learned, and how good it is.

    :param config: settings of the training
    :param learned: what was learned
    :param path: path of the run folder
    """
    from sarah.episode.accuracy import physics_warning
    from sarah.training.plan import plan_of

    task, evaluation, baseline = config.task, learned.evaluation, learned.baseline
    named = zip(task.parameter_names, learned.parameters, strict=True)
    print("\nrecommended " + ", ".join(f"{name} = {value:.2f}" for name, value in named))
    print(f"warm-up     {plan_of(config).warm_up_words()}")
    neutral = "the baseline (V = 0)" if task is BALANCE else "neutral parameters"
    compared = [("", evaluation), *([] if baseline is None else [(f" for {neutral}", baseline)])]
    scores = ", ".join(f"{one.mean('score'):.3f}{name}" for name, one in compared)
    print(f"score       {scores} (mean of {evaluation.episodes} unseen seeds; 1 is the ceiling)")
    print(f"steps       {evaluation.mean('steps_per_second'):.2f} per second")
    print("survival    " + ", ".join(f"{one.survival_rate:.0%}{name}" for name, one in compared))
    shifts, lifts = evaluation.mean("shifts_by_sensors"), evaluation.mean("lifts_by_sensors")
    clearance = 1000 * evaluation.mean("sole_clearance")
    print(f"by sensors  {shifts:.0%} of shifts, {lifts:.0%} of lifts; sole clearance {clearance:.0f} mm")
    if learned.diverged:
        print(f"diverged    {learned.diverged} episodes: their simulation gave no finite state")
    for shortcoming in evaluation.shortcomings(task.must_step, baseline):
        print(f"            {shortcoming}")
    warning = physics_warning(task, learned.parameters, config.episode)
    if warning is not None:
        print(f"physics     {warning}")
    print(f"run folder  {path}")
