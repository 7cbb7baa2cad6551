"""The command that makes results by name, for experiments, timings and endurance tests alike."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from experiments.age import say_ages
from experiments.found import Package, find, questions
from experiments.making import make
from sarah.cli.options import as_command
from sarah.errors import ConfigurationError

HELP = """{command} NAME: make a result, and write each of its rows as soon as it is known.

The same command goes on where it was stopped. What follows a name are options; {command} NAME --help shows them. An
experiment that options change writes to build/experiments/ instead of results/.

{command} age: how many commits since have touched what each result depends on.
"""


def main(package: Package, arguments: Sequence[str]) -> None:
    """Do what the arguments of a command say.

    :param package: experiments that the command has
    :param arguments: arguments of the process
    """
    if not arguments or arguments[0] in ("-h", "--help"):
        print(HELP.format(command=package.command))
        known = questions(package)
        print("\n".join(f"{name:{max(map(len, known))}}  {question}" for name, question in known.items()))
    elif arguments[0] == "age":
        if arguments[1:]:
            raise ConfigurationError(f"age takes no arguments, not {arguments[1]!r}")
        say_ages(package)
    else:
        name, *options = arguments
        print(make(find(name, package), f"{package.command} {name}", options))


def run(package: Package) -> None:
    """Run a command in this process.

    :param package: experiments that the command has
    """
    with as_command(package.command):
        main(package, sys.argv[1:])
