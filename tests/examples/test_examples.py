"""Every program of ``examples/`` is short, says what one sees, and runs."""

import ast
import os
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).parents[2] / "examples"
LONGEST = 40
ENGINES = {"two_engines": ("pybullet", "mujoco")}
"""Engines that an example cannot do without."""

every_example = pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)


@every_example
def test_an_example_runs(path: Path, tmp_path: Path) -> None:
    missing = [engine for engine in ENGINES.get(path.stem, ()) if find_spec(engine) is None]
    if missing:
        pytest.skip(f"needs {' and '.join(missing)}")
    process = subprocess.run(
        [sys.executable, path],
        cwd=tmp_path,
        env={**os.environ, "TMPDIR": str(tmp_path)},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert process.returncode == 0, process.stderr
    assert process.stdout


@every_example
def test_an_example_is_short_says_what_one_sees_and_is_listed(path: Path) -> None:
    text = path.read_text()
    assert len(text.splitlines()) <= LONGEST
    assert "\nOne sees " in (ast.get_docstring(ast.parse(text)) or "")
    assert f"({path.name})" in (EXAMPLES / "README.md").read_text()


def test_the_hip_law_recovers_from_the_push_that_locked_hips_do_not() -> None:
    process = subprocess.run([sys.executable, EXAMPLES / "push_and_recover.py"], capture_output=True, text=True)
    locked, law = process.stdout.splitlines()
    assert "left_box" in locked and "time_limit" in law
