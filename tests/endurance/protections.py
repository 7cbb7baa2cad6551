"""Does a test fail when a protection is taken out?

Each is taken out of a copy of the package. ``protections.tsv`` has what users are promised, the file that keeps the
promise, its code that does, what stands there instead, and the name of the test that must fail then.
"""

import csv
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from pandas import DataFrame, read_csv

from benchmarks.timing import Timing
from experiments.record import ROOT, ResultError, Row
from experiments.tables import table

FILE = Path(__file__).with_suffix(".tsv")
LINES = read_csv(FILE, sep="\t", quoting=csv.QUOTE_NONE, keep_default_na=False)
PROTECTIONS = {line["promise"]: line for line in LINES.to_dict("records")}
"""All protections by what they promise."""


@dataclass(frozen=True)
class Protections(Timing):
    """Every protection in turn.

    :param count: number of the protections, from the first
    """

    depends_on = ("sarah", "tests")
    count: int = len(PROTECTIONS)

    def cases(self) -> list[Row]:
        return [{"promise": promise} for promise in list(PROTECTIONS)[: self.count]]

    def rows(self, promise: str) -> Iterator[Row]:
        protection = PROTECTIONS[promise]
        place = place_of(protection["test"])
        with tempfile.TemporaryDirectory() as folder:
            package = Path(folder, "sarah")
            shutil.copytree(ROOT / "sarah", package)
            file = package / protection["file"]
            text = file.read_text(encoding="utf-8")
            if text.count(protection["code"]) != 1:
                raise ResultError(f"{protection['file']} does not have this once: {protection['code']}")
            file.write_text(text.replace(protection["code"], protection["instead"]), encoding="utf-8")
            options = ["-q", "-x", "-p", "no:cacheprovider", "-c", str(ROOT / "setup.cfg")]
            command = [sys.executable, "-m", "pytest", *options, str(ROOT / place)]
            environment = {**os.environ, "PYTHONPATH": f"{folder}{os.pathsep}{ROOT}"}
            tests = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True)
        if tests.returncode != 1:
            raise ResultError(f"{place} does not fail without this: {promise}\n{tests.stdout[-1000:]}")
        yield {"test": place}


def place_of(test: str) -> str:
    """A test with its file, as pytest takes it."""
    files = ROOT.glob("tests/**/test_*.py")
    (file,) = (path for path in files if f"def {test}(" in path.read_text(encoding="utf-8"))
    return f"{file.relative_to(ROOT)}::{test}"


FULL = Protections()
QUICK = Protections(count=1)


def answer(rows: DataFrame) -> str:
    """How many protections have a test."""
    return (
        f"{len(rows)} of {len(PROTECTIONS)} protections were taken out of a copy of the package, one at a time. Each "
        "time the test that watches it failed."
    )


def watched(rows: DataFrame) -> str:
    """What is promised, and the test of it."""
    shown = rows.assign(test=[f"`{place.partition('::')[2]}`" for place in rows.test])
    return table(shown, ["promise", "test"], "Protections, and the test that fails without each.")
