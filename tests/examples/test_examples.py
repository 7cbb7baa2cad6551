"""Every program of ``examples/`` is short, says what one sees, and runs."""

import ast
import runpy
from pathlib import Path

import pytest
from laboratory import need

EXAMPLES = Path(__file__).parents[2] / "examples"
LONGEST = 40
ENGINES = {"two_engines": ("pybullet", "mujoco")}
ARGUMENTS = {"naf_on_pendulum": ("100",)}
WITHOUT_ROS = ("relay_to_ros",)
"""Examples that test_relay.py runs."""


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_is_short_and_listed_and_one_sees_something(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for engine in ENGINES.get(path.stem, ()):
        need(engine)
    text = path.read_text()
    assert len(text.splitlines()) <= LONGEST and f"({path.name})" in (EXAMPLES / "README.md").read_text()
    assert "\nOne sees " in (ast.get_docstring(ast.parse(text)) or "")
    if path.stem in WITHOUT_ROS:
        return
    monkeypatch.setattr("sys.argv", [str(path), *ARGUMENTS.get(path.stem, ())])
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    runpy.run_path(str(path), run_name="__main__")
    lines = capsys.readouterr().out.splitlines()
    assert lines
    if path.stem == "push_and_recover":  # locked hips do not, and the hip law does
        assert "left_box" in lines[0] and "time_limit" in lines[1]
