"""What a training was begun with, in the first row of its journal: settings, this package's code, others' versions.

All other rows depend on it, so a training in which one of these differs would not go on exactly, and is refused.
"""

from __future__ import annotations

import os
from dataclasses import replace
from pathlib import Path
from typing import Any

from sarah.errors import ResumeError
from sarah.files import open_regular, quoted
from sarah.runs import rows
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import settings_by_key
from sarah.versions import differences, versions


def first_row(config: TrainingConfig) -> bytes:
    """First row of the journal of a training that begins here and now.

    :param config: settings of the training
    """
    return rows.first_row(_origin_of(config))


def check_origin(path: Path, config: TrainingConfig) -> None:
    """Refuse a training that was begun with other settings, code or versions.

    :param path: path of its journal
    :param config: settings of the training
    :raises ResumeError: naming what differs, here and there
    """
    try:
        with open_regular(path, os.O_RDONLY) as file:
            first = file.readline(rows.LONGEST_ROW)
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
    there = rows.read_first_row(first)
    if there is None:
        raise ResumeError(
            f"{path.parent} cannot be resumed: the first row of {path.name}, which says with what the training was "
            "begun, is damaged or missing"
        )
    if different := differences(_origin_of(config), there, "in this training"):
        again = quoted(path.with_name("config.yaml"))
        raise ResumeError(
            f"{path.parent} cannot be resumed: {different}: put that back, or train anew with --config {again}"
        )


def _origin_of(config: TrainingConfig) -> dict[str, Any]:
    begun = replace(config, episodes=config.stages[0], extended_from=())  # the journal has a row for each extension
    settings = settings_by_key(begun)
    for name in ("pictures", "extended_from"):  # pictures change no result
        del settings[name]
    return {**settings, **versions()}
