"""Experiments by name: each is a module, whose ``FULL`` is the experiment and whose ``QUICK`` takes seconds."""

from __future__ import annotations

import ast
import re
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from experiments.record import ROOT
from sarah.errors import ConfigurationError, unknown_name


class Package(NamedTuple):
    """A package of experiments, each of which makes a result."""

    command: str  # what is written before an experiment's name to run it
    folders: tuple[str, ...]  # names of the packages that hold their modules


EXPERIMENTS = Package("python -m experiments", ("experiments.robot", "experiments.naf"))
BENCHMARKS = Package("python -m benchmarks", ("benchmarks",))
ENDURANCE = Package("python -m tests.endurance", ("tests.endurance",))
PACKAGES = (EXPERIMENTS, BENCHMARKS, ENDURANCE)


def paths_of(*packages: Package) -> dict[str, Path]:
    """Files of all experiments by name. Modules without ``QUICK`` are what several experiments share.

    :param packages: packages of experiments; by default all
    """
    folders = [ROOT.joinpath(*folder.split(".")) for package in packages or PACKAGES for folder in package.folders]
    paths = [path for folder in folders for path in sorted(folder.glob("*.py"))]
    return {path.stem: path for path in paths if "\nQUICK = " in path.read_text(encoding="utf-8")}


def sources(name: str) -> set[str]:
    """Files of an experiment's module and of the modules beside it that it imports from, directly or not."""
    folders = "|".join(re.escape(folder) for package in PACKAGES for folder in package.folders)
    found = {}
    waiting = [paths_of()[name]]
    while waiting:
        path = waiting.pop()
        found[str(path)] = text = path.read_text(encoding="utf-8")
        imported = re.findall(rf"^from ((?:{folders})[.]\w+) import", text, re.MULTILINE)
        files = (ROOT.joinpath(*one.split(".")).with_suffix(".py") for one in imported)
        waiting += [file for file in files if str(file) not in found]
    return set(found)


def questions(*packages: Package) -> dict[str, str]:
    """Question of each experiment by its name, which need not be imported.

    :param packages: packages of experiments; by default all
    """
    modules = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in paths_of(*packages).items()}
    return {name: first_line(ast.get_docstring(module)) for name, module in modules.items()}


def first_line(docstring: str | None) -> str:
    """Question of an experiment, which is the first line of its module."""
    return str(docstring).partition("\n")[0]


def find(name: str, *packages: Package) -> ModuleType:
    """Import an experiment.

    :param packages: packages of experiments; by default all
    :raises ConfigurationError: if there is no such experiment
    """
    paths = paths_of(*packages)
    if name not in paths:
        raise ConfigurationError(unknown_name("experiment", name, paths))
    return import_module(".".join(paths[name].relative_to(ROOT).with_suffix("").parts))
