"""The results on the disk: ``results/<name>.csv``, whose first lines ``# key: value`` say how the rows were made."""

from __future__ import annotations

import csv
import io
import itertools
import re
import subprocess
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sarah.errors import SarahError
from sarah.files import replace_text

if TYPE_CHECKING:
    from pandas import DataFrame

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "results"
MADE_HERE = ("results", "docs")
"""Folders whose changes leave what an experiment computes as it is."""
UNKNOWN = "unknown"
"""What stands in place of a commit where there is no history."""
HEAD = re.compile(r"# ([\w ]+): (.*)")
Row = Mapping[str, Any]
"""Value by column; the column's name ends in its unit."""


class ResultError(SarahError):
    """A result that cannot be made or read."""


@dataclass(frozen=True)
class Result:
    """A result as it stands on the disk."""

    name: str  # file name without suffix
    question: str  # sentence that the rows answer
    command: str  # command that made them
    commit: str  # commits of the project at that time, the oldest first; ``unknown`` where there was no history
    date: str  # day, as YYYY-MM-DD
    minutes: float | None = None  # time that they took on one core; none if nobody took it
    missing: int = 0  # number of cases that are still to be made
    tree: str = ""  # ``dirty`` if the project had changes that no commit has
    remark: str = ""  # sentence that a page has to say about the rows
    options: str = ""  # of the experiment, but for those that no row depends on
    versions: str = ""  # of Python, the project and the packages it computes with
    rows: Sequence[Mapping[str, str]] = field(default=(), repr=False)  # texts by column

    @property
    def made_at(self) -> str:
        """When the last rows were made, and at which commits all of them, in words."""
        dirty = " with uncommitted changes" if self.tree else ""
        commits = " and ".join(", ".join(self.commit.split()).rsplit(", ", 1))
        return f"Made at {commits}{dirty} on {self.date}"

    @property
    def table(self) -> DataFrame:
        """The rows, with numbers where all of a column are numbers; empty cells are no number."""
        import pandas

        text = io.StringIO("\n".join(_csv_lines(self.rows)))
        return pandas.read_csv(text, keep_default_na=False, na_values=[""])


def names(folder: Path = RESULTS) -> list[str]:
    """Names of all results."""
    return sorted(path.stem for path in folder.glob("*.csv"))


def read(name: str, folder: Path = RESULTS) -> Result:
    """Read a result.

    :raises ResultError: if there is none, or its head or a row is incomplete
    """
    path = folder / f"{name}.csv"
    try:
        lines = path.read_text(encoding="utf-8").splitlines()
        head = list(itertools.takewhile(HEAD.match, lines))
        about: dict[str, Any] = dict(HEAD.findall("\n".join(head)))
        about |= {key: kind(about[key]) for key, kind in (("minutes", float), ("missing", int)) if key in about}
        rows = list(csv.DictReader(lines[len(head) :]))
        if wrong := [row for row in rows if None in row or None in row.values()]:
            raise ValueError(f"a row has more or fewer cells than columns: {next(iter(wrong[0].values()))}")
        return Result(name, rows=rows, **about)
    except FileNotFoundError as error:
        raise ResultError(f"there is no {path}") from error
    except (TypeError, ValueError, csv.Error) as error:  # keys of the head are arguments of a result
        raise ResultError(f"{path} is no result: {str(error).removeprefix('Result.__init__() ')}") from error


def write(result: Result, folder: Path = RESULTS) -> None:
    """Write a result in place of the one that was there."""
    kept = {key: value for key, value in vars(result).items() if key not in ("name", "rows")}
    head = [f"# {key}: {cell(value)}" for key, value in kept.items() if value or key == "commit"]
    replace_text(folder / f"{result.name}.csv", "\n".join([*head, *_csv_lines(result.rows), ""]))


def _csv_lines(rows: Sequence[Row]) -> Iterator[str]:
    text = io.StringIO(newline="")
    if rows:
        writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({column: cell(value) for column, value in row.items()} for row in rows)
    yield from text.getvalue().splitlines()


def cell(value: Any) -> str:
    """A number or text as it stands in the file; None leaves the cell empty."""
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def git(*arguments: str) -> str | None:
    """What git prints of the project; none if there is no git, or no history."""
    try:
        done = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True)
    except OSError:
        return None
    return done.stdout.strip() if done.returncode == 0 else None


def commit() -> str:
    """Short hash of the project's commit, or ``unknown`` in an archive that was unpacked."""
    inside = git("rev-parse", "--show-toplevel")
    is_own = inside is not None and Path(inside).resolve() == ROOT.resolve()
    return (git("rev-parse", "--short", "HEAD") or UNKNOWN) if is_own else UNKNOWN


def changed_files() -> list[str]:
    """Files that are new or changed since the commit, but for those that leave results as they are."""
    excluded = [f":(exclude){folder}" for folder in MADE_HERE]
    listed = git("status", "--porcelain", "--", ".", *excluded) or ""
    return [line.split(maxsplit=1)[1] for line in listed.splitlines()]
