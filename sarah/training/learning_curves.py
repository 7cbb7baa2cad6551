"""Learning curves, for tables and for TensorBoard.

This module replaces stable-baselines3's writers. The order of the columns in their CSV files changes from process to
process, and TensorBoard's own writer notices a full disk only in a thread.
"""

from __future__ import annotations

from typing import Any

from google.protobuf.message import DecodeError
from stable_baselines3.common.logger import filter_excluded_keys
from tensorboard.backend.event_processing.event_file_loader import LegacyEventFileLoader
from tensorboard.compat.proto.event_pb2 import Event
from tensorboard.compat.proto.summary_pb2 import Summary
from tensorboard.plugins.hparams import summary_v2 as hparams

from sarah.episode.push import PushedConfig
from sarah.files import LARGEST
from sarah.runs.config import TrainingConfig
from sarah.runs.event_file import EventFile
from sarah.runs.run_folder import RunFolder

LEARNED = ("unseen/score", "unseen/steps_per_second", "unseen/survival_rate", "unseen/sole_clearance")
"""Names of the final values of a training, which TensorBoard shows beside its hyper-parameters."""


class CurveWriter:
    """Writer of a training's ``progress.csv`` and of TensorBoard's event file.

    :param run: run folder of the training
    """

    def __init__(self, run: RunFolder) -> None:
        self._run = run
        self._columns: list[str] = []
        self._events = EventFile(run.path)
        config = hyper_parameters(run.config())
        metrics = [hparams.Metric(name) for name in LEARNED]
        self._events.add(Event(summary=hparams.hparams_config_pb([hparams.HParam(name) for name in config], metrics)))
        self._events.add(Event(summary=hparams.hparams_pb(config, trial_id=str(run.path))))

    def write(self, values: dict[str, Any], excluded: dict[str, tuple[str, ...]], step: int) -> None:
        """Add a point to each curve.

        :param values: values by name of the curve
        :param excluded: formats that leave a curve out, ``"csv"`` or ``"tensorboard"``, by name of the curve
        :param step: number of episodes so far
        """
        row = filter_excluded_keys(values, excluded, "csv")
        new = sorted(row.keys() - set(self._columns))
        if new:
            is_widened, self._columns = bool(self._columns), [*self._columns, *new]
            if is_widened:
                self._run.widen_progress(self._columns)
        if row:
            self._run.append_progress(self._columns, row)
        shown = filter_excluded_keys(values, excluded, "tensorboard")
        self._events.add_points(shown, step)

    def show(self, pictures: Summary, step: int) -> None:
        """Add pictures, which only TensorBoard shows.

        :param pictures: pictures to add
        :param step: number of episodes so far
        """
        self._events.add(Event(step=step, summary=pictures))

    def close(self) -> None:
        """Close the event file."""
        self._events.close()


def kept_pictures(run: RunFolder) -> dict[int, Summary]:
    """Pictures that TensorBoard has of a training, by the number of episodes before them.

    What is damaged, or of a size that would fill the memory, is left out: such pictures are drawn again.

    :param run: run folder of the training
    """
    kept = {}
    for path in run.event_files():
        if not path.is_file() or path.stat().st_size > LARGEST:
            continue
        try:
            for event in LegacyEventFileLoader(str(path)).Load():
                if any(value.HasField("image") for value in event.summary.value):
                    kept[event.step] = event.summary
        except (OSError, ValueError, DecodeError):
            continue
    return kept


def hyper_parameters(config: TrainingConfig) -> dict[str, str | int | float]:
    """Values of a training for TensorBoard's table of hyper-parameters: few, and the same columns for all trainings.

    :param config: settings of the training
    """
    episode = config.episode
    return {
        "task": config.task.name,
        "algorithm": config.algo,
        "episodes": config.episodes,
        "seed": config.seed,
        "slots": config.slots,
        "engine": episode.engine,
        "time_limit": episode.time_limit,
        "push_newtons": "{:g} to {:g}".format(*episode.push.newtons) if isinstance(episode, PushedConfig) else "none",
    }
