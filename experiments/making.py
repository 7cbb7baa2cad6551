"""Making a result: what is known stays, what is missing is computed, and each case is kept as soon as it is known."""

from __future__ import annotations

import argparse
import dataclasses
import re
import shlex
import sys
import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from types import ModuleType

from tqdm import tqdm

from experiments import record
from experiments.experiment import Experiment
from experiments.found import first_line
from experiments.record import Result, Row, cell
from sarah.cli.options import parse_options
from sarah.errors import ConfigurationError, unknown_name
from sarah.versions import versions

OTHER_RESULTS = record.ROOT / "build" / "experiments"
"""Folder for the rows of experiments that options change."""
MAY_BE_0 = ("workers", "seed", "first_seed")
"""Options of a whole number that may be 0; all others count what an experiment cannot do without."""
SHARED_OPTIONS = """Every experiment has these options too:

  --quick           a size that takes seconds, and shows only that it runs
  --only KEY=VALUE  cases with this value of one of their first columns; may be repeated, also for several values
  --out FOLDER      folder for the file
"""


def make(module: ModuleType, command: str, arguments: Sequence[str]) -> Path:
    """Make a result, or go on with one that was interrupted.

    :param module: module of the experiment
    :param command: the command, which names the experiment last
    :param arguments: options
    :return: file of the result
    :raises ConfigurationError: for options that are wrong
    :raises ResultError: if a result of the project was to be made of code that no commit has
    """
    shared, own = _parse_shared(arguments)
    full = module.FULL
    default = module.QUICK if shared.quick else full
    experiment = parse_options(type(default), command, own, default)
    _check_counts(experiment)
    every = experiment.cases()
    cases = _chosen(every, shared.only)
    is_whole = dataclasses.replace(experiment, workers=full.workers) == full and not shared.only
    folder = shared.out or (record.RESULTS if is_whole else OTHER_RESULTS)
    if folder.resolve() == record.RESULTS and (changed := record.changed_files()):
        files = ", ".join(changed[:3])
        raise record.ResultError(f"commit first what a result is made of, or put it elsewhere: {files} has changes")
    folder.mkdir(parents=True, exist_ok=True)
    whole = re.sub(r" --workers[ =]\S+", "", shlex.join([*command.split(), *arguments]))  # no row depends on them
    place = _place(module.__name__.rpartition(".")[2], folder)
    place.mkdir(parents=True, exist_ok=True)
    result = _begun(module, experiment, place, whole)
    left = _left(cases, result)
    if result.rows:
        print(f"goes on: {len(cases) - len(left)} of {len(cases)} cases are there", file=sys.stderr)
    if not shared.quick:
        _say_duration(left, result)
    try:
        _compute(experiment, left, result, place)
    except KeyboardInterrupt:
        there = place / f"{result.name}.csv"
        what = f"complete cases are in {there}, and" if there.exists() else "no case is complete yet;"
        print(f"{what} the same command goes on", file=sys.stderr)
        raise
    if place != folder:
        record.write(record.read(result.name, place), folder)
        (place / f"{result.name}.csv").unlink()
    return folder / f"{result.name}.csv"


def _parse_shared(arguments: Sequence[str]) -> tuple[argparse.Namespace, list[str]]:
    """The options that all experiments have, and the other arguments."""
    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--out", type=Path)
    shared, own = parser.parse_known_args(arguments)
    if {"-h", "--help"} & set(own):
        print(SHARED_OPTIONS)
    if shared.out and shared.out.exists() and not shared.out.is_dir():
        raise ConfigurationError(f"--out must be a folder, and {shared.out} is a file")
    return shared, own


def _check_counts(experiment: Experiment) -> None:
    """Refuse whole numbers that are too low."""
    for option, value in vars(experiment).items():
        lowest = 0 if option in MAY_BE_0 else 1
        for number in value if isinstance(value, tuple) else (value,):
            if type(number) is int and number < lowest:
                raise ConfigurationError(f"--{option.replace('_', '-')} must be at least {lowest}, not {number}")


def _chosen(cases: Sequence[Row], only: Iterable[str]) -> list[Row]:
    """Cases with the given values; of several values of a column, with any of them."""
    wanted: dict[str, set[str]] = {}
    for condition in only:
        key, equals, value = condition.partition("=")
        if not equals:
            raise ConfigurationError(f"--only takes KEY=VALUE, not {condition!r}")
        if key not in cases[0]:
            raise ConfigurationError(f"--only takes KEY=VALUE; {unknown_name('key', key, cases[0])}")
        allowed = list(dict.fromkeys(cell(case[key]) for case in cases))
        if value not in allowed:
            raise ConfigurationError(f"--only: {unknown_name(key, value, allowed)}")
        wanted.setdefault(key, set()).add(value)
    return [case for case in cases if all(cell(case[key]) in values for key, values in wanted.items())]


def _place(name: str, folder: Path) -> Path:
    """Folder in which rows are kept as they come: a result that is complete stays until the new one is."""
    if name not in record.names(folder) or record.read(name, folder).missing:
        return folder
    print(f"{folder / name}.csv stays as it is until all cases are computed", file=sys.stderr)
    return OTHER_RESULTS / "unfinished"


def _left(cases: Sequence[Row], result: Result) -> list[Row]:
    """Cases that a result lacks."""
    known = [{column: row.get(column) for column in cases[0]} for row in result.rows]
    return [case for case in cases if _cells(case) not in known]


def _cells(case: Row) -> dict[str, str]:
    """A case as it stands in the file."""
    return {column: cell(value) for column, value in case.items()}


def _say_duration(left: Sequence[Row], result: Result) -> None:
    """Say how long the cases that are left will take, as far as those of the result or of the one before tell."""
    if not result.minutes and result.name in record.names():
        result = record.read(result.name)
    if left and result.minutes and result.rows:
        made = len({tuple(row.get(column) for column in left[0]) for row in result.rows})
        minutes = result.minutes * len(left) / made
        about = "a minute or less" if minutes < 1.5 else f"about {minutes:.0f} minutes"
        print(f"that takes {about} with one worker on a core of its own", file=sys.stderr)


def _begun(module: ModuleType, experiment: Experiment, folder: Path, command: str) -> Result:
    """The result that this command has begun with the same options, or a new one."""
    commit = record.commit()
    if commit == record.UNKNOWN:
        print("without a git history the result cannot tell its commit", file=sys.stderr)
    name, question = module.__name__.rpartition(".")[2], first_line(module.__doc__)
    new = Result(name, question, command, commit, time.strftime("%Y-%m-%d"), 0.0, options=experiment.options)
    new = dataclasses.replace(new, versions=_listed(versions()))
    if name not in record.names(folder):
        return new
    before = record.read(name, folder)
    if not before.missing:
        return new
    if before.command != command or before.options not in ("", new.options):
        print(f"begins anew: {folder / name}.csv has rows of another command or other options", file=sys.stderr)
        return new
    cases = [_cells(case) for case in experiment.cases()]
    rows = [row for row in before.rows if {column: row.get(column) for column in cases[0]} in cases]
    commits = " ".join(dict.fromkeys([*before.commit.split(), commit]))
    of_rows = {key: getattr(before, key) for key in ("minutes", "tree", "remark", "options")}  # true of those that stay
    used = _listed(versions(), dict(word.split(maxsplit=1) for word in before.versions.split(", ") if word))
    return dataclasses.replace(new, commit=commits, versions=used, rows=rows, **of_rows)


def _listed(used: Mapping[str, str], before: Mapping[str, str] | None = None) -> str:
    """Versions in words; where rows of before were made with another one, that stands first."""
    known = {name: version.split(" and ") for name, version in (before or {}).items()}
    every = {name: dict.fromkeys([*known.get(name, ()), used.get(name, "none")]) for name in {**known, **used}}
    return ", ".join(f"{name} {' and '.join(those)}" for name, those in every.items())


def _compute(experiment: Experiment, left: Sequence[Row], result: Result, folder: Path) -> None:
    """Compute the cases that a result lacks, and write it after each."""
    rows, seconds = [*result.rows], 60.0 * (result.minutes or 0.0)
    with tqdm(total=len(left), unit=" cases") as progress:
        for number, (made, duration) in enumerate(experiment.outcomes(left), start=1):
            for row in made:
                tqdm.write(", ".join(f"{column} {cell(value)}" for column, value in row.items()))
            rows += made
            seconds += duration
            missing = len(left) - number
            record.write(dataclasses.replace(result, rows=rows, missing=missing, minutes=seconds / 60.0), folder)
            progress.update()
