"""The file of a log while it is written: chunk by chunk, so that it can be read up to the last whole one."""

from __future__ import annotations

import datetime
import os
import time
from collections.abc import Mapping
from io import FileIO
from pathlib import Path
from typing import Any

from sarah.errors import ConfigurationError, one_line
from sarah.files import check_file
from sarah.logs.topics import TOPICS

ABOUT, END = "sarah", "sarah-end"
"""Names of the metadata: what is known at the beginning, and at the end."""
LONGEST_SECONDS = 1e9
"""Largest time in a log, in s: thirty years."""
CHUNK_SECONDS = 0.9
"""Time after which a chunk is finished, in s: what a log can lose is a little more."""


def check_new(path: Path) -> None:
    """Refuse a file that could not be written as a log, before the run that it is for. No log is ever replaced.

    :param path: path of the file
    :raises ConfigurationError: if it is there already, or could not be written
    """
    check_file(path)
    if path.exists():
        raise ConfigurationError(f"{path} is there already: name another file for the log")


class _Output:
    """What the library writes, kept until it is whole."""

    def __init__(self, path: Path) -> None:
        check_new(path)
        try:
            self.file = FileIO(path, "xb")
        except OSError as error:
            raise ConfigurationError(f"cannot write {path}: {error.strerror or error}") from error
        self._parts: list[bytes] = []
        self._written = self._position = 0

    def write(self, data: bytes) -> None:
        """Keep some bytes."""
        self._parts.append(data)
        self._position += len(data)

    def tell(self) -> int:
        """Position at which the next bytes will be in the file."""
        return self._position

    def flush(self) -> None:
        """Write all bytes that are kept; if that fails, the file ends where it ended before."""
        left = memoryview(b"".join(self._parts))
        self._parts.clear()
        try:
            while left:
                left = left[self.file.write(left) or 0 :]
        except OSError:
            os.ftruncate(self.file.fileno(), self._written)
            raise
        self._written = self._position


class ChunkFile:
    """An MCAP file of messages in chunks. The first failure ends writing, and the file stays as it is.

    :param path: path of the file, which must be new
    :param about: facts about the run, by name
    :raises ConfigurationError: if the file is there already, or cannot be written
    """

    failure: str | None
    """Why nothing is written any more; ``None`` while all is well."""
    lost: int
    """Number of messages that were not written."""

    def __init__(self, path: Path, about: Mapping[str, str]) -> None:
        from mcap.writer import Writer

        self.failure, self.lost = None, 0
        self._output = _Output(path)
        self._writer = Writer(self._output)  # type: ignore[arg-type]  # which needs no more of a file
        self._messages, self._began = 0, 0.0
        started = datetime.datetime.now(datetime.timezone.utc).isoformat()
        try:
            self._writer.start()
            self._writer.add_metadata(
                ABOUT, {"started": started, **{name: str(value) for name, value in about.items()}}
            )
            self._channels = {name: self._registered(name) for name in TOPICS}
            self._output.flush()
        except OSError as error:
            self._fail(error)

    def _registered(self, name: str) -> int:
        topic = TOPICS[name]
        schema = self._writer.register_schema(topic.schema, "jsonschema", topic.json_schema)
        return self._writer.register_channel(name, "json", schema)

    def add(self, topic: str, sequence: int, seconds: float, *given: Any) -> None:
        """Add a message, and finish the chunk if it is its time. Whatever is wrong with it, nothing is raised.

        :param topic: name of the topic
        :param sequence: number of the message among those of its topic
        :param seconds: time since the run began, in s
        :param given: what else the topic makes a message of
        """
        if self.failure is not None:
            self.lost += 1
            return
        try:
            data = TOPICS[topic].encoded(seconds, *given)
            nanoseconds = round(1e9 * min(max(seconds, 0.0), LONGEST_SECONDS))
        except Exception:  # a value of any type, from a driver that anybody wrote
            self.lost += 1
            return
        self.add_encoded(topic, sequence, nanoseconds, data)

    def add_encoded(self, topic: str, sequence: int, nanoseconds: int, data: bytes) -> None:
        """Add a message that is JSON already.

        :param topic: name of the topic
        :param sequence: number of the message among those of its topic
        :param nanoseconds: time since the run began, in ns
        :param data: JSON
        """
        self._began = self._began if self._messages else time.monotonic()
        self._messages += 1
        self._guarded(self._writer.add_message, self._channels[topic], nanoseconds, data, nanoseconds, sequence)
        if self.seconds_left == 0.0:
            self.finish_chunk()

    @property
    def seconds_left(self) -> float | None:
        """Time until the chunk is to be finished, in s; ``None`` if it has no messages."""
        return max(0.0, self._began + CHUNK_SECONDS - time.monotonic()) if self._messages else None

    def finish_chunk(self) -> None:
        """Write all messages so far into the file."""
        self._guarded(self._writer.flush)
        self._messages = 0

    def close(self, end: Mapping[str, str]) -> None:
        """Write the last chunk and the index, and close the file.

        :param end: facts that are known at the end, by name
        """
        if self._output.file.closed:
            return
        self.finish_chunk()
        self._guarded(self._writer.add_metadata, END, dict(end))
        self._guarded(self._writer.finish)
        self._guarded(self._output.flush)
        self._guarded(self._output.file.close)

    def _guarded(self, write: Any, *arguments: Any) -> None:
        if self.failure is None:
            try:
                write(*arguments)
            except Exception as error:  # a log never ends what it is about
                self._fail(error)

    def _fail(self, error: Exception) -> None:
        self.failure = f"{error.strerror or error}" if isinstance(error, OSError) else one_line(error)
        self.lost += self._messages
        self._messages = 0
        self._output.file.close()
