"""TensorBoard's event file, written at once: TensorBoard's own writer notices a full disk only in a thread."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from tensorboard.compat.proto.event_pb2 import Event
from tensorboard.compat.proto.summary_pb2 import Summary
from tensorboard.summary.writer.record_writer import RecordWriter

from sarah.recorded.folder import EVENTS


class EventFile:
    """A new event file.

    :param folder: folder to write it to
    """

    def __init__(self, folder: Path) -> None:
        # TensorBoard takes the last file in the alphabet for the newest.
        self._file = (folder / f"{EVENTS}{time.time():.0f}.{socket.gethostname()}.{os.getpid()}").open("wb")
        self._events = RecordWriter(self._file)
        self.add(Event(file_version="brain.Event:2"))

    def add(self, event: Event) -> None:
        """Write an event, with the time of now.

        :param event: event to write
        """
        event.wall_time = time.time()
        self._events.write(event.SerializeToString())
        self._file.flush()

    def add_points(self, values: Mapping[str, Any], step: int) -> None:
        """Add a point to each curve.

        :param values: values by name of the curve
        :param step: step of all points
        """
        points = [Summary.Value(tag=name, simple_value=float(value)) for name, value in sorted(values.items())]
        self.add(Event(step=step, summary=Summary(value=points)))

    def close(self) -> None:
        """Close the file."""
        self._file.close()
