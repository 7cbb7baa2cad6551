"""How many changes to core files do the tests of their package see?

One change after another is made to a copy of a file. Each is a mutant, and tests that fail kill it.
``survivors.tsv`` says of which mutants no test is wanted, by their changed line, and why.
"""

import csv
import os
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from pandas import DataFrame, read_csv

from benchmarks.timing import Timing
from experiments.record import ROOT, ResultError, Row
from experiments.tables import shown, table

LEAST_KILLED = 0.9
"""Share of each file's mutants that its tests have to kill, without those that ``survivors.tsv`` explains."""
EXPLAINED = read_csv(Path(__file__).with_name("survivors.tsv"), sep="\t", quoting=csv.QUOTE_NONE)
COPIED = ("agents", "sarah", "tests", "urdf", "setup.cfg")


class Subject(NamedTuple):
    """How a file's mutants are tested.

    :param tests: arguments of pytest that select the fast tests of its package
    :param definitions: regular expression of the functions and classes that are changed; empty names are the module's
    """

    tests: str
    definitions: str = ".*"


CONTROL = ("parameters", "baselines", "pattern_generator", "hip_law", "supervisor", "faults")
"""Tests of the controller that simulate nothing, the quickest first."""


def control_tests(own: str) -> str:
    """The controller's tests, a file's own first: those kill most of its mutants."""
    return " ".join(f"tests/control/test_{name}.py" for name in sorted(CONTROL, key=lambda name: name != own))


GAIT = "tests/episode/test_gait_and_reward.py"
REWARD = f"{GAIT} tests/robot/test_scale.py"
ENDING = "tests/episode/test_ending.py -k criteria"
SENSORS = "tests/simulation/test_sensors.py -k 'not push'"
CRITIC = "tests/agents/test_naf_equations.py"
TARGETS = (
    "tests/agents/test_naf_targets.py tests/agents/test_naf_warnings.py tests/agents/test_naf_train_eval_mode.py "
    "tests/agents/test_naf_values.py tests/agents/test_naf_run.py::test_rewards_far_from_zero_get_a_warning_once "
    "-k 'not published_runs_away'"
)
BUFFERS = "tests/agents/test_rank_buffer.py tests/agents/test_replay_without_luck.py tests/agents/test_naf_arguments.py"

SUBJECTS = {
    "sarah/control/baselines.py": Subject(control_tests("baselines")),
    "sarah/control/pattern_generator.py": Subject(control_tests("pattern_generator")),
    "sarah/control/hip_law.py": Subject(control_tests("hip_law")),
    "sarah/control/constants.py": Subject(control_tests("hip_law"), "ControllerConstants"),
    "sarah/control/parameters.py": Subject(control_tests("parameters")),
    "sarah/episode/reward.py": Subject(REWARD, "(?!RewardSettings).*"),
    "sarah/episode/gait.py": Subject(GAIT, "(?!GaitSettings|GaitMetrics).*"),
    "sarah/episode/ending.py": Subject(ENDING, "(?!EndingSettings).*"),
    "sarah/simulation/sensors.py": Subject(SENSORS),
    "agents/critic.py": Subject(CRITIC),
    "agents/buffers.py": Subject(BUFFERS),
    "agents/naf.py": Subject(TARGETS, "train"),
}
"""The files. Of NAF its updates, with the equations."""


@dataclass(frozen=True)
class Mutants(Timing):
    """Mutants of every file.

    :param files: names of the files
    :param count: largest number of mutants of a file
    """

    depends_on = ("agents", "sarah/control", "sarah/episode", "sarah/simulation", "tests")
    files: tuple[str, ...] = tuple(SUBJECTS)
    count: int = 10_000

    def cases(self) -> list[Row]:
        return [{"file": file} for file in self.files]

    def rows(self, file: str) -> Iterator[Row]:
        with tempfile.TemporaryDirectory() as folder:
            for name in COPIED:
                if (ROOT / name).is_dir():
                    ignore = shutil.ignore_patterns("__pycache__")
                    shutil.copytree(ROOT / name, Path(folder, name), symlinks=True, ignore=ignore)
                else:
                    shutil.copy2(ROOT / name, folder)
            row = judged(file, SUBJECTS[file], Path(folder), self.count)
        unexplained = row["mutants"] - row["explained"]
        if row["killed"] < LEAST_KILLED * unexplained:
            raise ResultError(
                f"tests kill only {row['killed']} of the {unexplained} mutants of {file} that nobody explains"
            )
        yield row


FULL = Mutants()
QUICK = Mutants(files=("sarah/episode/reward.py",), count=2)


def judged(file: str, subject: Subject, tree: Path, count: int) -> Row:
    """Test the mutants of a file, and print what survives."""
    from .mutation import mutated, mutations  # takes long to import

    start = time.perf_counter()
    if not passes(subject.tests, tree, None):  # leaves compiled modules for the mutants' tests
        raise ResultError(f"the tests of {file} fail without a change")
    patience = 10.0 * (time.perf_counter() - start)
    tried = mutations(tree / file, subject.definitions)[:count]
    explained_here = EXPLAINED[EXPLAINED.file == file]
    reasons = dict(zip(explained_here.code, explained_here.reason, strict=True))
    survivors = []
    for mutation in tried:
        with mutated(mutation) as (line, code):
            if passes(subject.tests, tree, patience):
                survivors.append(code)
                print(f"{file}:{line}: {code}\n    {reasons.get(code, 'SURVIVED, and nobody says why')}")
    for code in reasons.keys() - survivors:
        print(f"{file}: explained, but killed or not tried: {code}")
    explained = sum(code in reasons for code in survivors)
    return {
        "mutants": len(tried),
        "killed": len(tried) - len(survivors),
        "explained": explained,
        "survived": len(survivors) - explained,
    }


def passes(tests: str, tree: Path, patience: float | None) -> bool:
    """Whether tests pass; an endless loop is a failure."""
    options = ["-x", "-q", "-p", "no:cacheprovider", "--hypothesis-seed=0", *shlex.split(tests)]
    environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "x" if patience else ""}
    command = [sys.executable, "-m", "pytest", *options]
    try:
        done = subprocess.run(command, cwd=tree, env=environment, capture_output=True, timeout=patience)
    except subprocess.TimeoutExpired:
        return False
    return done.returncode == 0


def answer(rows: DataFrame) -> str:
    """How many mutants are killed."""
    killed, unexplained = rows.killed / rows.mutants, rows.survived.sum()
    return (
        f"Tests kill {shown(rows.killed.sum() / rows.mutants.sum(), '.1%')} of all mutants, and at least "
        f"{shown(killed.min(), '.1%')} of those of each file. {unexplained or 'No'} mutants survive without an "
        "explanation."
    )


def killed(rows: DataFrame) -> str:
    """Mutants of each file."""
    shares = rows.assign(share_killed=rows.killed / rows.mutants)
    caption = "Mutants of each file: killed by its tests, survivors that are explained, and other survivors."
    columns = ["file", "mutants", "killed", "share_killed", "explained", "survived"]
    return table(shares, columns, caption, share_killed=".1%")
