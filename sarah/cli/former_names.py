"""Former names of options, which commands accept for one more release. What they write is now always ``--out``."""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence

from sarah.files import quoted

OUT = "--out"


def with_out(
    command: str, arguments: Sequence[str], former: Mapping[str, str] | None = None, bare: int | None = None
) -> list[str]:
    """Arguments that name what to write by ``--out``; standard error says what a former name is called.

    :param command: name of the command
    :param arguments: arguments after the command's name
    :param former: words that take the place of a former option, by its name; the last of them is ``--out``
    :param bare: number of words at the beginning, none of them an option, behind which the place to write stood alone
    """
    if OUT in (argument.partition("=")[0] for argument in arguments):
        return list(arguments)
    words = list[str]()
    for index, argument in enumerate(arguments):
        option, equals, value = argument.partition("=")
        place = value if equals else "".join(arguments[index + 1 : index + 2])
        present = (former or {}).get(option.replace("_", "-"))
        if index == bare and not any(word.startswith("-") for word in arguments[: index + 1]):
            words += [OUT, argument]
            say_present(command, argument, OUT, argument)
        elif present is not None and place and (equals or not place.startswith("-")):
            words += [*present.split(), *([value] if equals else [])]
            say_present(command, f"{option} {place}", present, place)
        else:
            words.append(argument)
    return words


def say_present(command: str, former: str, present: str, value: str) -> None:
    """Say on standard error what is to be written instead.

    :param command: name of the command
    :param former: words that were given
    :param present: option that takes their place
    :param value: value of the option
    """
    instead = f"{present} {quoted(value)}"
    print(f"{command}: say {instead} instead of {former}, which the next release refuses", file=sys.stderr)
