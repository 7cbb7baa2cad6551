"""Reading a log, whoever wrote the file and wherever it ends: up to the last whole chunk."""

from __future__ import annotations

import io
import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from sarah.errors import ConfigurationError
from sarah.files import open_regular
from sarah.logs.chunk_file import ABOUT, END
from sarah.logs.topic import Values
from sarah.logs.topics import TOPICS

MAGIC = b"\x89MCAP0\r\n"
"""Bytes with which an MCAP file begins and ends."""
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, METADATA = 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x0C
_RECORD = struct.Struct("<BQ")
_MESSAGE = struct.Struct("<HIQQ")
LARGEST_CHUNK = 2**26
"""Largest size of a record in the file, and of a chunk's messages, in bytes."""


class Message(NamedTuple):
    """A message of a log.

    :param topic: name of its topic
    :param sequence: number among the messages of the topic; where one is missing, a message was dropped
    :param nanoseconds: time since the run began, in ns
    :param data: JSON
    """

    topic: str
    sequence: int
    nanoseconds: int
    data: bytes

    @property
    def seconds(self) -> float:
        """Time since the run began, in s."""
        return self.nanoseconds / 1e9


class _DamageError(Exception):
    """Bytes that are no record, and what is wrong with them."""


class Log:
    """A log as it lies on the disk. What the attributes say is known once all messages have been read.

    :param path: path of the file
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self.about: dict[str, str] = {}
        """Facts about the run, by name."""
        self.end: dict[str, str] = {}
        """Facts that were known at its end; none if it was cut."""
        self.problem: str | None = None
        """Where and how the file ends before it is complete; ``None`` if it is whole."""
        self._schemas: dict[int, tuple[str, str]] = {}
        self._channels: dict[int, str] = {}
        self._others: set[str] = set()

    def messages(self) -> Iterator[Message]:
        """All messages of this package's topics, in the order of the file, up to its last whole chunk.

        :raises ConfigurationError: if the file is no MCAP file, or none of this package's
        """
        try:
            with io.BufferedReader(open_regular(self.path)) as file:  # type: ignore[type-var]  # it is a raw file
                yield from self._messages(file)
        except OSError as error:
            raise ConfigurationError(f"cannot read {self.path}: {error.strerror or error}") from error
        if self._others and not self._channels:
            topics = ", ".join(sorted(self._others)[:5])
            raise ConfigurationError(f"{self.path} is not a log of sarah: its topics are {topics:.200}")

    def values(self, message: Message) -> Values:
        """Values of a message by the names of its fields.

        :param message: message of this log
        :raises ConfigurationError: if it is not as its topic says
        """
        try:
            return TOPICS[message.topic].decoded(message.data)
        except ConfigurationError as error:
            raise ConfigurationError(f"{self.path}: {error}") from error

    def _messages(self, file: BinaryIO) -> Iterator[Message]:
        if file.read(len(MAGIC)) != MAGIC:
            raise ConfigurationError(f"{self.path} is not an MCAP file")
        size, position, opcode = file.seek(0, io.SEEK_END), file.seek(len(MAGIC)), HEADER
        while opcode != FOOTER:
            head = file.read(_RECORD.size)
            opcode, length = _RECORD.unpack(head) if len(head) == _RECORD.size else (0, size)
            if position + _RECORD.size + length > size:
                self.problem = f"cut at byte {position}"
                return
            try:
                messages = self._record(opcode, _bounded(file, length))
            except _DamageError as damage:
                self.problem = f"damaged at byte {position}: {damage}"
                return
            yield from messages
            position += _RECORD.size + length
        if file.read() != MAGIC:
            self.problem = f"cut at byte {position}"

    def _record(self, opcode: int, content: bytes) -> list[Message]:
        """Learn what a record says, and return the messages of a chunk.

        :raises _DamageError: if it is no record of its kind
        """
        from mcap.data_stream import ReadDataStream
        from mcap.exceptions import McapError
        from mcap.records import Channel, Chunk, Metadata, Schema

        stream = ReadDataStream(io.BytesIO(content))
        try:
            if opcode == CHUNK:
                return self._of_chunk(_decompressed(Chunk.read(stream)))
            if opcode == SCHEMA:
                schema = Schema.read(stream)
                self._schemas.setdefault(schema.id, (schema.name, schema.encoding))
            elif opcode == CHANNEL:
                self._add_channel(Channel.read(stream))
            elif opcode == METADATA:
                metadata = Metadata.read(stream)
                {ABOUT: self.about, END: self.end}.get(metadata.name, {}).update(metadata.metadata)
        except (McapError, struct.error, ValueError, OverflowError) as error:
            if isinstance(error, ConfigurationError):
                raise
            raise _DamageError("a record is not what it should be") from error
        return []

    def _add_channel(self, channel: Any) -> None:
        if channel.id in self._channels:  # each comes again at the end of the file
            return
        if channel.topic not in TOPICS:
            self._others.add(channel.topic)
            return
        expected, found = (TOPICS[channel.topic].schema, "jsonschema"), self._schemas.get(channel.schema_id)
        if found != expected or channel.message_encoding != "json":
            name = found[0] if found else "none"
            raise ConfigurationError(
                f"{self.path} is not a log of sarah: {channel.topic} has the schema {name:.100}, not {expected[0]}"
            )
        self._channels[channel.id] = channel.topic

    def _of_chunk(self, data: bytes) -> list[Message]:
        messages, position, channels = [], 0, self._channels
        while position < len(data):
            opcode, length = _RECORD.unpack_from(data, position)
            begin = position + _RECORD.size
            position = begin + length
            if position > len(data):
                raise _DamageError("a record is longer than its chunk")
            if opcode == MESSAGE:
                channel, sequence, nanoseconds, _ = _MESSAGE.unpack_from(data, begin)
                if channel in channels:
                    content = data[begin + _MESSAGE.size : position]
                    messages.append(Message(channels[channel], sequence, nanoseconds, content))
            elif opcode != CHUNK:  # no chunk is within another
                self._record(opcode, data[begin:position])
        return messages


def _bounded(file: BinaryIO, length: int) -> bytes:
    if length > LARGEST_CHUNK:
        raise _DamageError(f"a record has more than {LARGEST_CHUNK} bytes")
    return file.read(length)


def _decompressed(chunk: Any) -> bytes:
    import zstandard

    if chunk.uncompressed_size > LARGEST_CHUNK:
        raise _DamageError(f"a chunk has more than {LARGEST_CHUNK} bytes")
    if chunk.compression == "zstd":
        try:
            if zstandard.frame_content_size(chunk.data) not in (-1, chunk.uncompressed_size):  # -1: not said
                raise _DamageError("a chunk has another size than it says")
            data = zstandard.decompress(chunk.data, chunk.uncompressed_size)
        except zstandard.ZstdError as error:
            raise _DamageError("a chunk is not compressed as it says") from error
    elif chunk.compression == "":
        data = chunk.data
    else:
        raise _DamageError(f"compression {chunk.compression!r:.50} is not known")
    if chunk.uncompressed_crc not in (0, zlib.crc32(data)):
        raise _DamageError("a chunk has another checksum than it says")
    return data
