"""``python -m experiments NAME``: make a result; without a name, list all of them with their questions.

What follows a name are options: ``--quick`` for a size that takes seconds, ``--out FOLDER`` for the files, and those of
the experiment, which ``python -m experiments NAME --help`` shows. An experiment that options change writes to
build/experiments/ instead of results/. One whose rows take hours writes each at once, and the same
command goes on where it was stopped.

``python -m experiments stale WHY [NAME...]`` has the pages say of results that they are not of today's project.
"""

from __future__ import annotations

import argparse
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

from experiments import record
from experiments.experiment import Experiment, RowByRowExperiment
from experiments.made_with import differences, made_with
from sarah.cli.options import as_command, parse_options
from sarah.errors import ConfigurationError, unknown_name

COMMAND = "python -m experiments"
OTHER_RESULTS = record.ROOT / "build" / "experiments"
"""Folder for the rows of experiments that options change."""
HARMLESS = {"workers", "runs", "courses"}
"""Options that change no row."""
MAY_BE_0 = {"workers", "seed", "first_seed", "reference_episodes", "reference_pushes"}
"""Options of a whole number that may be 0; all others count what an experiment cannot do without."""


def main(arguments: Sequence[str]) -> None:
    """Do what the arguments of the command say.

    :param arguments: arguments of the process
    """
    # Not before: worker processes import this module, and most of them need little of what experiments import.
    from experiments.table import TABLE

    if not arguments or arguments[0] in ("-h", "--help"):
        print(__doc__)
        width = max(map(len, TABLE))
        print("\n".join(f"{name:{width}}  {maker.question}" for name, maker in TABLE.items()))
    elif arguments[0] == "stale":
        mark_stale(record.RESULTS, *arguments[1:])
    elif arguments[0] in TABLE:
        make(arguments[0], arguments[1:])
    else:
        raise ConfigurationError(unknown_name("experiment", arguments[0], [*TABLE, "stale"]))


def make(name: str, arguments: Sequence[str]) -> None:
    """Make a result, and print its rows as they come.

    :param name: name of the result
    :param arguments: options
    """
    from experiments.shipped_parameters import ShippedParameters, ship
    from experiments.table import TABLE

    parser = argparse.ArgumentParser(add_help=False, allow_abbrev=False)
    parser.add_argument("--quick", action="store_true")
    parser.add_argument("--out", type=Path)
    shared, own = parser.parse_known_args(arguments)
    if {"-h", "--help"} & set(own):
        print("Every experiment has --quick, for a size that takes seconds, and --out FOLDER, for the files.\n")
    maker = TABLE[name]
    default = maker.quick_experiment if shared.quick else maker.experiment
    experiment = parse_options(type(default), f"{COMMAND} {name}", own, default)
    check_counts(experiment)
    if shared.out and shared.out.exists() and not shared.out.is_dir():
        raise ConfigurationError(f"--out must be a folder, and {shared.out} is a file")
    folder = shared.out or (record.RESULTS if makes_the_result(experiment, maker.experiment) else OTHER_RESULTS)
    folder.mkdir(parents=True, exist_ok=True)
    command = shlex.join([*COMMAND.split(), name, *arguments])
    begun = begun_result(name, folder, command)

    def write(missing: int = 0) -> None:
        fingerprint = made_with() if maker.of_robot else None
        record.write(name, rows, maker.question, command, fingerprint, folder, missing, begun.commit if begun else "")

    rows: list[record.Row] = [*begun.rows] if begun else []
    for row in experiment.rows(rows) if isinstance(experiment, RowByRowExperiment) else experiment.rows():
        print(", ".join(f"{column} {record.cell(value)}" for column, value in row.items()), flush=True)
        rows.append(row)
        if isinstance(experiment, RowByRowExperiment):
            write(len(experiment.keys()) - len(rows))
    write()
    print(folder / f"{name}.csv")
    if isinstance(experiment, ShippedParameters) and folder.resolve() == record.RESULTS:
        ship(record.read(name))


def begun_result(name: str, folder: Path, command: str) -> record.Result | None:
    """A result that this command has begun, and that today's project would go on with.

    :param name: name of the result
    :param folder: folder of the results
    :param command: the command
    """
    if name not in record.names(folder):
        return None
    result = record.read(name, folder)
    goes_on = result.missing and result.command == command and not result.stale and not is_outdated(result)
    return result if goes_on else None


def check_counts(experiment: Experiment) -> None:
    """Refuse whole numbers that are too low.

    :param experiment: an experiment with some options
    """
    for option, value in vars(experiment).items():
        lowest = 0 if option in MAY_BE_0 else 1
        for number in value if isinstance(value, tuple) else (value,):
            if isinstance(number, int) and not isinstance(number, bool) and number < lowest:
                raise ConfigurationError(f"--{option.replace('_', '-')} must be at least {lowest}, not {number}")


def makes_the_result(experiment: Experiment, full: Experiment) -> bool:
    """Whether an experiment makes the rows that the pages show.

    :param experiment: an experiment with some options
    :param full: the same in its full size
    """
    return all(vars(experiment)[option] == value for option, value in vars(full).items() if option not in HARMLESS)


def mark_stale(folder: Path, reason: str = "", *names: str) -> None:
    """Have the pages say that results are not of today's project.

    :param folder: folder of the results
    :param reason: sentence that says why
    :param names: names of the results; by default all that were made with another physics, controller or robot
    """
    if not reason.endswith("."):
        raise ConfigurationError(f"WHY must be a sentence, which the pages show, not {reason!r}")
    known = record.names(folder)
    for name in names:
        if name not in known:
            raise ConfigurationError(unknown_name("result", name, known))
    for name in names or [name for name in known if is_outdated(record.read(name, folder))]:
        record.mark_stale(name, reason, folder)
        print(folder / f"{name}.json")


def is_outdated(result: record.Result) -> bool:
    """Whether a result was made with another physics, controller or robot, and does not say so yet.

    :param result: the result
    """
    return result.made_with is not None and result.stale is None and bool(differences(result.made_with, made_with()))


if __name__ == "__main__":
    with as_command(COMMAND):
        main(sys.argv[1:])
