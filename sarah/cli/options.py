"""Parts that all commands share: parsing of options, and one line for a user's mistake."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import io
import itertools
import os
import re
import sys
from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from typing import Any, NoReturn, TypeVar

import tyro

from sarah.cli.value_rules import REGISTRY
from sarah.episode.push import PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import Task, load_task
from sarah.errors import ConfigurationError, SarahError, unknown_name
from sarah.files import is_text
from sarah.number import NUMBER
from sarah.ranges import Range, types_of
from sarah.simulation.engines import default_engine
from sarah.streams import check_output, keep_streams

OptionsType = TypeVar("OptionsType")
USAGE_ERROR = 2
DIMENSIONS = "--episode.dimensions"
"""Option of the robot's dimensions."""
PYTHON_WORDS = {
    r"^Error parsing (\S+): (must be .*)": r"\1 \2",
    r"^Error parsing (\S+): Could not parse arguments (.*) into tuple type .*": r"\1 must be numbers, not \2",
    r"^Error parsing (--forces): Could not find valid parse for arguments: (.*)": r"\1 must be numbers, not \2",
    r"^Error parsing (\S+): Could not find valid parse for arguments: (.*)": r"\1 must be whole numbers, not \2",
    r"^Error parsing (\S+): no type matching (\S+) could be instantiated from (.*?)\.\s+Got errors.*": (
        r"\1 must be \2, not \3"
    ),
    r"^Error parsing [\w.]+: ": "",
}
"""Python's messages about bad values, and the messages that a user gets instead."""


def named_task(reference: str | None) -> Task[Any] | None:
    """Task of an option ``--task``, which runs the file that it names.

    :param reference: value of the option, or ``None`` if it was not given
    """
    return None if reference is None else load_task(reference)


def fail(command: str, message: str) -> NoReturn:
    """Print one line that says what is wrong, and exit.

    :param command: name of the command
    :param message: message, which becomes one line
    """
    print(f"{command}: error: {printable(' '.join(message.split()))}", file=sys.stderr)
    raise SystemExit(USAGE_ERROR)


def printable(line: str) -> str:
    """A line as a terminal may print it, whoever wrote the file that it is from.

    :param line: line, whose control characters are escaped
    """
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in line)


def _with_both_ends(arguments: Sequence[str], config: Any) -> list[str]:
    """Arguments in which a range has both its ends, also where one number was given for both."""
    ranges = {f"--{name}" for name in _ranges_of(config)}
    words: list[str] = []
    for argument in arguments:
        option, equals, value = argument.partition("=")
        is_range = option.replace("_", "-") in ranges
        words += [option, value] if is_range and equals else [argument]
    completed: list[str] = []
    for index, word in enumerate(words):
        completed.append(word)
        if word.replace("_", "-") in ranges:
            ends = list(itertools.takewhile(_is_number, words[index + 1 :]))
            following = words[index + 1 : index + 2]
            if len(ends) > 2 or not all(map(NUMBER.match, ends)) or (not ends and following != ["None"]):
                given = " ".join(ends or following) or "nothing"
                raise ConfigurationError(f"{word} must be one number, or two for a range, not {given}")
            completed += ends[:1] if len(ends) == 1 else []
    return completed


def without_dimensions(arguments: Sequence[str]) -> tuple[list[str], list[str]]:
    """Arguments beside those of the robot's dimensions, and names and numbers of these, of one option or of several.

    :param arguments: arguments of a command
    """
    others: list[str] = []
    words: list[str] = []
    are_dimensions = False
    for argument in arguments:
        option, equals, word = argument.partition("=")
        if option == DIMENSIONS:
            are_dimensions = True
            words += [word] if equals else []
            continue
        are_dimensions = are_dimensions and not argument.startswith("--")
        (words if are_dimensions else others).append(argument)
    return others, words


def _with_dimensions_once(arguments: Sequence[str]) -> Sequence[str]:
    others, words = without_dimensions(arguments)
    return [*others, DIMENSIONS, *words] if words else arguments


def _checked(words: Sequence[str]) -> Sequence[str]:
    """Arguments, none of which is empty, or a name that no file, message or page could hold.

    :param words: the arguments
    :raises ConfigurationError: if one is empty, as an unset variable of the shell is: it would be the working folder;
        or if one has control characters, or bytes that are not UTF-8
    """
    for before, word in zip(("", *words), words, strict=False):
        option, equals, value = word.partition("=")
        name = option if equals and option else before if before.startswith("--") and before[2:] else "an argument"
        if not value and (equals or not option):
            raise ConfigurationError(f"{name} must not be empty")
        if not is_text(word):
            given = f"{value or word!r:.300}"
            raise ConfigurationError(f"{name} must be UTF-8 text without control characters, not {given}")
    return words


def _ranges_of(config: Any) -> Iterator[str]:
    """Names of the options of some settings that are ranges."""
    types = types_of(type(config))
    for item in dataclasses.fields(config):
        value, name = getattr(config, item.name), item.name.replace("_", "-")
        if dataclasses.is_dataclass(value) and not isinstance(value, Task):
            yield from (f"{name}.{inner}" if name != "training" else inner for inner in _ranges_of(value))
        elif types[item.name] in (Range, Range | None):
            yield name


def _is_number(text: str) -> bool:
    """Whether a word after a range is meant as one of its numbers; what is spelled otherwise is refused."""
    return bool(NUMBER.match(text) or re.fullmatch(r"[-+]?\.?\d[\d._:]*", text.strip()))


def parse_options(
    options_type: type[OptionsType], command: str, arguments: Sequence[str], default: OptionsType
) -> OptionsType:
    """Make a command's options from its arguments; ``--help`` prints the help and exits.

    :param options_type: dataclass of the options; its docstring is the help
    :param command: name of the command
    :param arguments: arguments after the command's name
    :param default: options with their default values
    """
    parse = functools.partial(tyro.cli, options_type, prog=command, default=default, registry=REGISTRY)
    errors = io.StringIO()
    try:
        with contextlib.redirect_stderr(errors):
            return parse(args=_checked(_with_both_ends(_with_dimensions_once(arguments), default)))
    except SystemExit as exit_request:
        if not exit_request.code:
            check_output()
            raise
    help_text = io.StringIO()
    with contextlib.redirect_stdout(help_text), contextlib.suppress(SystemExit):
        parse(args=["--help"])
    names = " ".join(line for line in help_text.getvalue().splitlines() if line.startswith(("│ --", "  --")))
    fail(command, _one_line(errors.getvalue(), re.findall(r"--[\w.-]+", names)))


def _one_line(box: str, options: Sequence[str]) -> str:
    """Message in tyro's frame, with the option that is nearest to an unknown one.

    :param box: what tyro printed
    :param options: all options
    """
    # The title is dropped. A terminal without frames gets plain rules, and one of them comes first.
    text = " ".join(line.strip("╭╮╰╯│ ") for line in box.splitlines()[1:])
    message = next(section.strip() for section in re.split("[─-]{5,}", text) if section.strip())
    wrong = re.match(r"invalid choice '(.*)' for argument '(.*)'\. Expected one of \((.*)\)", message)
    if wrong:
        return unknown_name(wrong[2], wrong[1], re.findall(r"'(.*?)'", wrong[3]))
    for pattern, words in PYTHON_WORDS.items():
        message = re.sub(pattern, words, message)
    message = re.sub(r"^(Unrecognized options: --[^,]*),.*", r"\1", message)
    unknown = message.removeprefix("Unrecognized options: ")
    if unknown == message:
        return message
    longer = sorted((option for option in options if option.startswith(unknown)), key=len)
    nearest = longer or get_close_matches(unknown, options, n=1, cutoff=0.8)
    return f"{message}, did you mean {nearest[0]}?" if nearest else message


def pushed_words(config: EpisodeConfig) -> str:
    """How hard a robot is pushed, in words.

    :param config: settings of the episodes
    """
    low, high = config.push.newtons if isinstance(config, PushedConfig) else (0.0, 0.0)
    newtons = f"{low:.4g} N" if low == high else f"{low:.4g} to {high:.4g} N"
    return f"pushed by {newtons}" if high else "not pushed"


def say_engine(config: EpisodeConfig) -> None:
    """Print on standard error that MuJoCo simulates because PyBullet is missing.

    :param config: settings of the episodes
    """
    if config.engine == default_engine() != "pybullet":
        print("PyBullet is not installed, so MuJoCo simulates", file=sys.stderr)


@contextlib.contextmanager
def as_command(command: str) -> Iterator[None]:
    """Run a command, and print one line without a traceback if it raises one of the package's exceptions.

    :param command: name of the command
    """
    os.environ["MPLBACKEND"] = "Agg"  # figures are files, also where there is a display
    keep_streams()
    try:
        os.getcwd()  # torch ends the process if the working folder is gone
        yield
    except (SarahError, OSError) as error:
        fail(command, str(error))
    except KeyboardInterrupt:
        print(f"\n{command}: interrupted", file=sys.stderr)
        raise SystemExit(130) from None
