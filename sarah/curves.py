"""Learning curves, for tables and for TensorBoard.

Written here and not by stable-baselines3's writers: their CSV has its columns in another order in every process, and
TensorBoard's own writer has a thread that alone learns of a full disk.
"""

from __future__ import annotations

import os
import socket
import time
from typing import Any

from stable_baselines3.common.logger import filter_excluded_keys
from tensorboard.compat.proto.event_pb2 import Event
from tensorboard.compat.proto.summary_pb2 import Summary
from tensorboard.summary.writer.record_writer import RecordWriter

from sarah.runs import EVENTS, RunFolder


class LearningCurves:
    """``progress.csv`` and TensorBoard's event file of a run.

    :param run: the run folder
    """

    def __init__(self, run: RunFolder) -> None:
        self._run = run
        self._columns: list[str] = []
        # TensorBoard goes by the name: what comes later in the alphabet is newer.
        name = f"{EVENTS}{time.time():.0f}.{socket.gethostname()}.{os.getpid()}"
        self._file = (run.path / name).open("wb")
        self._events = RecordWriter(self._file)
        self._add(Event(file_version="brain.Event:2"))

    def write(self, values: dict[str, Any], excluded: dict[str, tuple[str, ...]], step: int) -> None:
        """Add a point to each curve.

        :param values: by name of the curve
        :param excluded: by name: where a value is not wanted, ``"csv"`` or ``"tensorboard"``
        :param step: simulations so far
        """
        row = filter_excluded_keys(values, excluded, "csv")
        new = sorted(row.keys() - set(self._columns))
        if new:
            is_widened, self._columns = bool(self._columns), [*self._columns, *new]
            if is_widened:
                self._run.widen_progress(self._columns)
        self._run.append_progress(self._columns, row)
        shown = filter_excluded_keys(values, excluded, "tensorboard")
        points = [Summary.Value(tag=name, simple_value=float(value)) for name, value in sorted(shown.items())]
        self._add(Event(step=step, summary=Summary(value=points)))

    def _add(self, event: Event) -> None:
        event.wall_time = time.time()
        self._events.write(event.SerializeToString())
        self._file.flush()

    def close(self) -> None:
        """Close the event file."""
        self._file.close()
