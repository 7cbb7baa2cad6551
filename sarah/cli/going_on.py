"""What ``--resume`` refuses and says, the same for trainings and sessions."""

from __future__ import annotations

from pathlib import Path

from sarah.errors import ConfigurationError


def check_same(path: Path, kind: str, key: str, there: object, given: object) -> None:
    """Refuse a setting that is not what it is in what goes on.

    :param path: folder of what goes on
    :param kind: ``training`` or ``session``
    :param key: name of the setting
    :param there: value in what goes on
    :param given: value on the command line
    """
    if given != there:
        raise ConfigurationError(f"--resume {path}: {key} is {there!r} in this {kind}, not {given!r}: leave it out")


def check_extendable(path: Path, option: str, is_finished: bool) -> None:
    """Refuse to extend what is not finished.

    :param path: folder of what goes on
    :param option: option that asks for more
    :param is_finished: whether it is finished
    """
    if not is_finished:
        raise ConfigurationError(f"--resume {path}: it can be extended once it is finished: leave {option} out")


def finished_words(path: Path, option: str, budget: float) -> str:
    """Words for what is finished, and would only go on with more.

    :param path: its folder
    :param option: option that asks for more
    :param budget: its present budget
    """
    return f"{path} is finished: to go on, add {option} with more than its {budget:g}"
