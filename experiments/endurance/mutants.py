"""Do the tests see? One change after another is made to a copy of core files, and the tests of the package must fail.

Cosmic Ray finds what it can change: numbers, arithmetic, comparisons, conditions, loops. Each change is a mutant, and
tests that fail kill it. ``mutants_tested.py`` has the files, their tests, and why some mutants cannot be killed.
"""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from experiments.endurance.mutants_tested import EXCLUDED, EXPLAINED, SUBJECTS, Subject
from experiments.record import ROOT, Row

LEAST_KILLED_PERCENT = 90.0
"""Percentage of each file's mutants that its tests have to kill."""
COPIED = ("agents", "sarah", "tests", "urdf", "setup.cfg")


@dataclass(frozen=True)
class Mutants:
    """Mutants of every file.

    :param files: beginning of the names of the files; empty for all of them
    :param count: largest number of mutants of a file
    """

    files: str = ""
    count: int = 10_000

    def rows(self) -> Iterator[Row]:
        """A row for each file; what survives is printed.

        :raises SystemExit: if the tests of a file kill too few
        """
        weak = []
        for subject in SUBJECTS:
            if not subject.file.startswith(self.files):
                continue
            with tempfile.TemporaryDirectory() as folder:
                row = judged(subject, copied(Path(folder, "sarah")), self.count)
            if row["killed_percent"] < LEAST_KILLED_PERCENT:
                weak.append(subject.file)
            yield row
        if weak:
            raise SystemExit(f"tests kill less than {LEAST_KILLED_PERCENT:g} % of the mutants of {', '.join(weak)}")


def copied(tree: Path) -> Path:
    """Copy what the tests need; links stay links.

    :param tree: folder of the copy
    """
    tree.mkdir()
    for name in COPIED:
        if (ROOT / name).is_dir():
            shutil.copytree(ROOT / name, tree / name, symlinks=True, ignore=shutil.ignore_patterns("__pycache__"))
        else:
            shutil.copy2(ROOT / name, tree)
    return tree


def judged(subject: Subject, tree: Path, count: int) -> dict[str, Any]:
    """Test the mutants of a file, and print what survives.

    :param subject: the file and its tests
    :param tree: copy of the project
    :param count: largest number of mutants
    """
    start = time.perf_counter()
    if not passes(subject, tree, None):  # leaves compiled modules for the mutants' tests
        raise SystemExit(f"the tests of {subject.file} fail without a change")
    patience = 10.0 * (time.perf_counter() - start)
    mutations = mutations_of(subject, tree)[:count]
    survivors = [mutant for mutation in mutations if (mutant := survivor(subject, tree, mutation, patience))]
    reasons = EXPLAINED.get(subject.file, {})
    for line, code in survivors:
        print(f"{subject.file}:{line}: {code}\n    {reasons.get(code, 'SURVIVED, and nobody says why')}")
    for code in reasons.keys() - {code for _, code in survivors}:
        print(f"{subject.file}: explained, but killed or not tried: {code}")
    explained = sum(code in reasons for _, code in survivors)
    return {
        "file": subject.file,
        "mutants": len(mutations),
        "killed": len(mutations) - len(survivors),
        "explained": explained,
        "survived": len(survivors) - explained,
        "killed_percent": round(100.0 * (1.0 - len(survivors) / len(mutations)), 1),
    }


def survivor(subject: Subject, tree: Path, mutation: Any, patience: float) -> tuple[int, str] | None:
    """Number and code of the line that a mutation has changed, if the tests pass nevertheless.

    :param subject: the file and its tests
    :param tree: copy of the project
    :param mutation: what Cosmic Ray changes
    :param patience: longest time for the tests, in s
    """
    from cosmic_ray.mutating import use_mutation
    from cosmic_ray.plugins import get_operator

    operator, line = get_operator(mutation.operator_name)(), mutation.start_pos[0]
    with use_mutation(mutation.module_path, operator, mutation.occurrence) as (_, mutated):
        return (line, mutated.splitlines()[line - 1].strip()) if passes(subject, tree, patience) else None


def mutations_of(subject: Subject, tree: Path) -> list[Any]:
    """Cosmic Ray's mutations of a file, in the order of its lines.

    :param subject: the file
    :param tree: copy of the project
    """
    from cosmic_ray.commands import init
    from cosmic_ray.plugins import OPERATOR_PROVIDERS
    from cosmic_ray.work_db import use_db

    from experiments.endurance.mutation_operators import OPERATORS

    OPERATOR_PROVIDERS["sarah"] = OPERATORS
    with use_db(tree / "session.sqlite") as session:
        init([tree / subject.file], session, {})
        mutations = [mutation for item in session.work_items for mutation in item.mutations]
    wanted = [
        mutation
        for mutation in mutations
        if not re.fullmatch(EXCLUDED, mutation.operator_name)
        and re.fullmatch(subject.definitions, mutation.definition_name or "")
    ]
    return sorted(wanted, key=lambda mutation: (mutation.start_pos, mutation.operator_name, mutation.occurrence))


def passes(subject: Subject, tree: Path, patience: float | None) -> bool:
    """Whether the tests of a file pass; an endless loop is a failure.

    :param subject: the file and its tests
    :param tree: copy of the project
    :param patience: longest time for the tests, in s; ``None`` for the file without a change
    """
    options = ["-x", "-q", "-p", "no:cacheprovider", "--hypothesis-seed=0", *shlex.split(subject.tests)]
    environment = {**os.environ, "PYTHONPATH": str(tree), "PYTHONDONTWRITEBYTECODE": "x" if patience else ""}
    command = [sys.executable, "-m", "pytest", *options]
    try:
        tests = subprocess.run(command, cwd=tree, env=environment, capture_output=True, timeout=patience)
    except subprocess.TimeoutExpired:
        return False
    return tests.returncode == 0
