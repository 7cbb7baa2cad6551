"""What every command does with its options, and with a user's mistake: one line and a non-zero exit."""

from __future__ import annotations

import contextlib
import io
import os
import re
import sys
from collections.abc import Callable, Sequence
from typing import NoReturn, TypeVar

import tyro

from sarah.errors import SarahError

OptionsType = TypeVar("OptionsType")
USAGE_ERROR = 2
PYTHON_WORDS = {
    r"^Error parsing (\S+): invalid literal for int\(\) with base 10: (.*)": r"\1 must be a whole number, not \2",
    r"^Error parsing (\S+): could not convert string to float: (.*)": r"\1 must be a number, not \2",
    r"^Error parsing [\w.]+: ": "",
}
"""What Python says of bad values, and what a user is told."""


def fail(command: str, message: str) -> NoReturn:
    """Say what is wrong in one line, and exit.

    :param command: name of the command
    :param message: what is wrong
    """
    print(f"{command}: error: {' '.join(message.split())}", file=sys.stderr)
    raise SystemExit(USAGE_ERROR)


def parse_options(
    options_type: type[OptionsType], command: str, arguments: Sequence[str], default: OptionsType
) -> OptionsType:
    """Make a command's options from its arguments; ``--help`` prints the help and exits.

    :param options_type: a dataclass; its docstring is the help
    :param command: name of the command
    :param arguments: that follow it
    :param default: what options that are not given are
    """
    errors = io.StringIO()
    try:
        with contextlib.redirect_stderr(errors):
            return tyro.cli(
                options_type,
                prog=command,
                args=list(arguments),
                config=(tyro.conf.FlagCreatePairsOff,),
                default=default,
            )
    except SystemExit as exit_request:
        if not exit_request.code:
            raise
        fail(command, _one_line(errors.getvalue()))


def _one_line(box: str) -> str:
    """The message in tyro's frame, and the name that it thinks was meant."""
    # Without the title. Where the terminal knows no frames, rules stand alone, and one comes first.
    text = " ".join(line.strip("╭╮╰╯│ ") for line in box.splitlines()[1:])
    message = next(section.strip() for section in re.split("[─-]{5,}", text) if section.strip())
    for pattern, words in PYTHON_WORDS.items():
        message = re.sub(pattern, words, message)
    meant = re.search(r"Perhaps you meant:\s+(--[\w.-]+)", text)
    return f"{message}, did you mean {meant[1]}?" if meant else message


def run_command(command: str, main: Callable[[Sequence[str]], None]) -> None:
    """Run a command; an error of ours is one line, without a traceback.

    :param command: its name
    :param main: what it does with its arguments
    """
    try:
        main(sys.argv[1:])
        sys.stdout.flush()
    except SarahError as error:
        fail(command, str(error))
    except BrokenPipeError:  # whoever read the output has had enough, as in `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        fail(command, str(error))
    except KeyboardInterrupt:
        print(f"\n{command}: interrupted", file=sys.stderr)
        raise SystemExit(130) from None
