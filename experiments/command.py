"""The command that makes results by name, for experiments, timings and endurance tests alike."""

from __future__ import annotations

import sys
from collections.abc import Sequence

from experiments import record
from experiments.found import Package, find, paths_of, questions, sources
from experiments.making import make
from sarah.cli.options import as_command
from sarah.errors import ConfigurationError

HELP = """{command} NAME: make a result, and write each of its rows as soon as it is known.

The same command goes on where it was stopped. What follows a name are options; {command} NAME --help shows them. An
experiment that options change writes to build/experiments/ instead of results/.

{command} age: how many commits since have touched what each result depends on.
"""


def main(package: Package, arguments: Sequence[str]) -> None:
    """Do what the arguments of a command say."""
    if not arguments or arguments[0] in ("-h", "--help"):
        print(HELP.format(command=package.command))
        _print_by_name(questions(package))
    elif arguments[0] == "age":
        if arguments[1:]:
            raise ConfigurationError(f"age takes no arguments, not {arguments[1]!r}")
        ages = {}
        for name in sorted(paths_of(package).keys() & set(record.names())):
            result, depends_on = record.read(name), (*find(name).FULL.depends_on, *sources(name))
            ages[name] = f"{result.made_at}: {age(result, depends_on)}"
        _print_by_name(ages)
    else:
        name, *options = arguments
        path = make(find(name, package), f"{package.command} {name}", options)
        print(path)
        if path.parent == record.RESULTS:
            print("make results puts it on its page", file=sys.stderr)


def _print_by_name(words: dict[str, str]) -> None:
    width = max(map(len, words), default=0)
    print("\n".join(f"{name:{width}}  {text}" for name, text in words.items()))


def age(result: record.Result, paths: tuple[str, ...]) -> str:
    """What has changed since a result was made in the folders and files that it depends on, in words."""
    first = result.commit.split()[0]
    if record.commit() == record.UNKNOWN or record.git("rev-parse", "--is-shallow-repository") == "true":
        return "cannot tell without the whole history"
    if record.git("merge-base", "--is-ancestor", first, "HEAD") is None:
        return f"cannot tell, as {first} is no earlier commit of this one"
    count = record.git("rev-list", "--count", f"{first}..HEAD", "--", *paths)
    return f"{count} commits since have touched what it depends on"


def run(package: Package) -> None:
    """Run a command in this process."""
    with as_command(package.command):
        main(package, sys.argv[1:])
