"""Parts of a log in other files: a span of time as a log, and each topic as a table."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import TextIO

from sarah.errors import ConfigurationError
from sarah.files import make_folder
from sarah.logs.chunk_file import ChunkFile
from sarah.logs.reading import Log
from sarah.logs.topics import TOPICS


def cut(log: Log, begin: float, end: float, path: Path) -> int:
    """Write the messages of a span of time as a log of its own, with the times that they had.

    :param log: log to read
    :param begin: time since the run began of the first messages, in s
    :param end: time of the last ones, in s
    :param path: path of the new log
    :return: number of messages
    :raises ConfigurationError: if a file cannot be read or written, or there is no message
    """
    part, count = None, 0
    for message in log.messages():
        if begin <= message.seconds <= end:
            part = part or ChunkFile(path, {**log.about, "cut_from": log.path.name})
            part.add_encoded(message.topic, message.sequence, message.nanoseconds, message.data)
            count += 1
    if part is None:
        raise ConfigurationError(f"{log.path} has no message from {begin:g} to {end:g} s")
    part.close({})
    if part.failure is not None:
        raise ConfigurationError(f"cannot write {path}: {part.failure}")
    return count


def export_csv(log: Log, folder: Path) -> list[Path]:
    """Write each topic as a table, such as ``ticks.csv``, with a column for each field.

    :param log: log to read
    :param folder: folder of the tables
    :return: paths of the tables
    :raises ConfigurationError: if a file cannot be read or written, or is there already
    """
    make_folder(folder)
    files: dict[str, TextIO] = {}
    try:
        tables = {}
        for name, topic in TOPICS.items():
            files[name] = (folder / f"{name[1:]}.csv").open("x", newline="", encoding="utf-8")
            tables[name] = csv.DictWriter(files[name], [field.name for field in topic.fields], extrasaction="ignore")
            tables[name].writeheader()
        for message in log.messages():
            tables[message.topic].writerow(log.values(message))
    except OSError as error:
        raise ConfigurationError(f"cannot write {error.filename or folder}: {error.strerror or error}") from error
    finally:
        for file in files.values():
            file.close()
    return [Path(file.name) for file in files.values()]
