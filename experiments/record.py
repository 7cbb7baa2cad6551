"""The results on the disk: ``results/<name>.csv`` with the rows, ``results/<name>.json`` with how they were made.

Reading needs nothing but the standard library, so that the documentation can be built anywhere.
"""

from __future__ import annotations

import csv
import io
import json
import re
import subprocess
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parent.parent
RESULTS = ROOT / "results"
Row = Mapping[str, Any]
"""Value by column; the column's name ends in its unit."""


@dataclass(frozen=True)
class Result:
    """A result as it stands on the disk.

    :param name: file name without suffix
    :param rows: texts by column
    :param question: sentence that the rows answer
    :param command: command that made them
    :param commit: commit of the project at that time
    :param date: day, as YYYY-MM-DD
    :param versions: versions of the packages by name
    :param made_with: fingerprint of physics, controller and robot, see :mod:`experiments.made_with`; none if the
        rows do not depend on them
    :param stale: sentence that says why the rows stand here although they are not of today's project
    :param missing: number of rows that are still to be made
    """

    name: str
    rows: list[dict[str, str]]
    question: str
    command: str
    commit: str
    date: str
    versions: dict[str, str]
    made_with: dict[str, Any] | None
    stale: str | None = None
    missing: int = 0

    @property
    def remark(self) -> str | None:
        """Sentence that a page has to say about the rows, if there is one."""
        return self.stale or (f"{self.missing} rows are still to be made." if self.missing else None)

    @property
    def columns(self) -> list[str]:
        """Names of the columns, in order."""
        return list(self.rows[0])


def names(folder: Path = RESULTS) -> list[str]:
    """Names of all results.

    :param folder: folder of the files
    """
    return sorted(path.stem for path in folder.glob("*.csv"))


def read(name: str, folder: Path = RESULTS) -> Result:
    """Read a result.

    :param name: its name
    :param folder: folder of the files
    """
    with (folder / f"{name}.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    return Result(name, rows, **json.loads((folder / f"{name}.json").read_text(encoding="utf-8")))


def write(
    name: str,
    rows: Sequence[Row],
    question: str,
    command: str,
    made_with: dict[str, Any] | None,
    folder: Path = RESULTS,
    missing: int = 0,
    earlier: str = "",
) -> None:
    """Write a result in place of the one that was there.

    :param name: its name
    :param rows: values by column, the same columns in every row
    :param question: sentence that they answer
    :param command: command that made them
    :param made_with: fingerprint from :func:`experiments.made_with.made_with`, or none
    :param folder: folder of the files
    :param missing: number of rows that are still to be made
    :param earlier: commits that made the first rows, if others did
    """
    from sarah.versions import versions

    commits = dict.fromkeys([*earlier.split(), commit()])
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows({column: cell(value) for column, value in row.items()} for row in rows)
    (folder / f"{name}.csv").write_text(text.getvalue(), encoding="utf-8")
    about = {
        "question": question,
        "command": command,
        "commit": " ".join(commits),
        "date": time.strftime("%Y-%m-%d"),
        "versions": versions(),
        "made_with": made_with,
    }
    if missing:
        about["missing"] = missing
    write_json(folder / f"{name}.json", about)


def mark_stale(name: str, reason: str, folder: Path = RESULTS) -> None:
    """Have the pages say that a result is not of today's project.

    :param name: its name
    :param reason: one sentence, which the pages show
    :param folder: folder of the files
    """
    path = folder / f"{name}.json"
    write_json(path, json.loads(path.read_text(encoding="utf-8")) | {"stale": reason})


def commit() -> str:
    """Short hash of the project's commit, with a plus sign if files other than results have been changed since."""
    git = ["git", "-C", str(ROOT)]
    head = subprocess.run([*git, "rev-parse", "--short", "HEAD"], capture_output=True, text=True)
    changed = subprocess.run(
        [*git, "status", "--porcelain", "--untracked-files=no", "--", ":(exclude)results"],
        capture_output=True,
        text=True,
    )
    return head.stdout.strip() + "+" * bool(changed.stdout.strip()) or "unknown"


def cell(value: Any) -> str:
    """A value as it stands in the file.

    :param value: number or text; None leaves the cell empty
    """
    if value is None:
        return ""
    return f"{value:.5g}" if isinstance(value, float) else str(value)


def write_json(path: Path, about: Mapping[str, Any]) -> None:
    """Write a JSON file, with each list of numbers on one line.

    :param path: the file
    :param about: its content
    """
    text = json.dumps(about, indent=2, ensure_ascii=False)
    text = re.sub(r"\[[^\[\]]*\]", lambda numbers: " ".join(numbers[0].split()), text)  # a list on one line
    path.write_text(f"{text}\n", encoding="utf-8")
