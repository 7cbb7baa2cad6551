"""What one does next: commands to copy, at the end of a command.

They go to standard error, so that whatever reads a command's output gets nothing but that.
"""

from __future__ import annotations

import shlex
import shutil
import sys
from collections.abc import Sequence
from importlib.util import find_spec
from pathlib import Path

from sarah.files import quoted

Step = tuple[str, Sequence[str | Path]]
"""Purpose of a command, and its words."""


def say_next(*steps: Step) -> None:
    """Print what one does next.

    :param steps: steps, three at most
    """
    sys.stdout.flush()  # what the command has to say comes first, also where both streams are one
    width = max(len(purpose) for purpose, _ in steps)
    for purpose, words in steps:
        print(f"to {purpose}: {' ' * (width - len(purpose))} {_line(words)}", file=sys.stderr)


def to_see(subject: str | Path, *others: str) -> Step:
    """Step to an episode: in the viewer, or as a video without it.

    :param subject: what to look at
    :param others: other words of the command, which may have the subject among them
    """
    words = others if subject in others else (subject, *others)
    return "see it", ("sarah-view", *words) if find_spec("viser") else ("sarah-video", *words, "--out", "episode.gif")


def to_watch(folder: Path) -> Step:
    """Step to the curves in TensorBoard.

    :param folder: folder of a training or a session, or a folder of some
    """
    return "watch its curves", ("tensorboard", "--logdir", folder)


def to_open(file: Path) -> Step:
    """Step to a file, in the browser.

    :param file: page, picture or video
    """
    return "open it", ("python", "-m", "webbrowser", file.resolve().as_uri())


def passed_on(arguments: Sequence[str], subject: str, *dropped: str) -> list[str]:
    """Arguments that another command takes as well.

    :param arguments: arguments of the command that ends
    :param subject: what it looked at, which is never the value of an option
    :param dropped: names of the options that the other command has not, without dashes
    """
    words, is_kept = list[str](), True
    for argument in arguments:
        if argument.startswith("--"):
            option = argument.partition("=")[0].replace("_", "-")
            is_kept = option.removeprefix("--").removeprefix("no-") not in dropped
        if is_kept or argument == subject:
            words.append(argument)
    return words


def _line(words: Sequence[str | Path]) -> str:
    """Words as one types them. A program that is not on the path is beside the one that runs."""
    beside = Path(sys.argv[0]).with_name(str(words[0]))
    program = quoted(beside) if not shutil.which(words[0]) and beside.is_file() else str(words[0])
    return " ".join([program, *(quoted(word) if isinstance(word, Path) else shlex.quote(word) for word in words[1:])])
