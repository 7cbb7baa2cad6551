"""Experiments by name: each is a module of its own, which need not be imported to be listed."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import NamedTuple, cast

from experiments.experiment import Experiment
from experiments.record import ROOT
from sarah.errors import ConfigurationError, unknown_name


class Package(NamedTuple):
    """A package of experiments, each of which makes a result.

    :param command: what is written before an experiment's name to run it
    :param folders: names of the packages that hold their modules
    """

    command: str
    folders: tuple[str, ...]


EXPERIMENTS = Package("python -m experiments", ("experiments.robot", "experiments.naf"))
BENCHMARKS = Package("python -m benchmarks", ("benchmarks",))
ENDURANCE = Package("python -m tests.endurance", ("tests.endurance",))
PACKAGES = (EXPERIMENTS, BENCHMARKS, ENDURANCE)


class Found(NamedTuple):
    """An experiment's module.

    :param name: name of the experiment and of its result
    :param module: the module; its ``FULL`` is the experiment in its full size, its ``QUICK`` in one that takes seconds
    """

    name: str
    module: ModuleType

    @property
    def question(self) -> str:
        """Sentence that the rows answer: the first line of the module."""
        return str(self.module.__doc__).partition("\n")[0]

    @property
    def full(self) -> Experiment:
        """The experiment in its full size."""
        return cast(Experiment, self.module.FULL)

    @property
    def quick(self) -> Experiment:
        """The experiment in a size that takes seconds, and shows only that it runs."""
        return cast(Experiment, self.module.QUICK)


def paths_of(*packages: Package) -> dict[str, Path]:
    """Files of all experiments by name. Modules without ``QUICK`` are what several experiments share.

    :param packages: packages of experiments; by default all
    """
    folders = [ROOT.joinpath(*folder.split(".")) for package in packages or PACKAGES for folder in package.folders]
    paths = [path for folder in folders for path in sorted(folder.glob("*.py"))]
    return {path.stem: path for path in paths if "\nQUICK = " in path.read_text(encoding="utf-8")}


def questions(*packages: Package) -> Mapping[str, str]:
    """Question of each experiment by its name.

    :param packages: packages of experiments
    """
    docstrings = {name: ast.get_docstring(ast.parse(path.read_text())) for name, path in paths_of(*packages).items()}
    return {name: str(docstring).partition("\n")[0] for name, docstring in docstrings.items()}


def find(name: str, *packages: Package) -> Found:
    """Import an experiment.

    :param name: its name
    :param packages: packages of experiments; by default all
    :raises ConfigurationError: if there is no such experiment
    """
    paths = paths_of(*packages)
    if name not in paths:
        raise ConfigurationError(unknown_name("experiment", name, paths))
    module = paths[name].relative_to(ROOT).with_suffix("")
    return Found(name, import_module(".".join(module.parts)))
