"""What a training was begun with, in the first row of its journal: settings, this package's code, others' versions.

All other rows depend on it, so a training in which one of these differs would not go on exactly, and is refused.
"""

from __future__ import annotations

import hashlib
import json
import os
import shlex
from pathlib import Path
from typing import Any

from sarah.errors import ResumeError
from sarah.files import open_regular
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import settings_by_key
from sarah.versions import differences, versions

LONGEST_ROW = 100_000
"""Largest number of bytes in a row of a journal; an episode's has some 1500."""


def first_row(config: TrainingConfig) -> bytes:
    """First row of the journal of a training that begins here and now: a hash and a JSON object.

    :param config: settings of the training
    """
    text = compact_json(_origin_of(config))
    return b"%s %s\n" % (_digest(text), text)


def checksum_seed(first: bytes) -> int:
    """Number that the checksums of all other rows begin from.

    :param first: first row of the journal
    """
    return int(first[:8], 16)


def check_origin(path: Path, config: TrainingConfig) -> None:
    """Refuse a training that was begun with other settings, code or versions.

    :param path: path of its journal
    :param config: settings of the training
    :raises ResumeError: naming what differs, here and there
    """
    try:
        with open_regular(path, os.O_RDONLY) as file:
            first = file.readline(LONGEST_ROW)
    except OSError as error:
        raise ResumeError(f"{path.parent} cannot be resumed: {error}") from error
    if not first_row(config).startswith(first):  # what was cut in its first row begins anew
        check_first_row(path, first, config)


def check_first_row(path: Path, first: bytes, config: TrainingConfig) -> None:
    """Refuse a journal's first row in which anything differs from what a training would begin with now.

    :param path: path of the journal
    :param first: its first row
    :param config: settings of the training
    :raises ResumeError: naming what differs, here and there
    """
    there = _read(first)
    if there is None:
        raise ResumeError(
            f"{path.parent} cannot be resumed: the first row of {path.name}, which says with what the training was "
            "begun, is damaged or missing"
        )
    if different := differences(_origin_of(config), there, "in this training"):
        again = shlex.quote(str(path.with_name("config.yaml")))
        raise ResumeError(
            f"{path.parent} cannot be resumed: {different}: put that back, or train anew with --config {again}"
        )


def compact_json(row: dict[str, Any]) -> bytes:
    """A row as JSON without spaces.

    :param row: values by name
    """
    return json.dumps(row, allow_nan=False, separators=(",", ":")).encode()


def _origin_of(config: TrainingConfig) -> dict[str, Any]:
    settings = settings_by_key(config.by_stage()[0])  # the journal has a row for each extension
    for name in ("pictures", "extended_from"):  # pictures change no result
        del settings[name]
    return {**settings, **versions()}


def _read(first: bytes) -> dict[str, Any] | None:
    """What a first row says; ``None`` if it is damaged."""
    digest, _, text = first.rstrip(b"\n").partition(b" ")
    try:
        origin = json.loads(text) if digest == _digest(text) else None
    except (ValueError, RecursionError):
        return None
    return origin if isinstance(origin, dict) else None


def _digest(text: bytes) -> bytes:
    return hashlib.sha256(text).hexdigest()[:16].encode()
