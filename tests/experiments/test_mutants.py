"""The mutation tester: it finds what a weak test lets through, and leaves the file as it was."""

from pathlib import Path

import pytest

from experiments.endurance import mutants
from experiments.endurance.mutants_tested import EXPLAINED, SUBJECTS, Subject

CODE = "def half(x):\n    return x / 2.5\n"
SUBJECT = Subject("half.py", "test_half.py")


def project(folder: Path, expected: float) -> Path:
    """A function and a test of its value at 4."""
    pytest.importorskip("cosmic_ray")
    (folder / "half.py").write_text(CODE)
    (folder / "test_half.py").write_text(
        f"from half import half\ndef test_half():\n    assert abs(half(4) - {expected}) < 0.3\n"
    )
    return folder


@pytest.mark.slow
def test_what_the_tests_do_not_see_survives_with_its_line_or_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Within 0.3 of 4 / 2.5 lie 4 / 2.75 and 4 - 2.5, but not 4 / 3.5, 4 / 1.5, 4 + 2.5 or 4 * 2.5."""
    monkeypatch.setitem(EXPLAINED, "half.py", {"return x / 2.75": "a tenth is nothing"})
    row = mutants.judged(SUBJECT, project(tmp_path, 1.6), 100)
    counts = {"mutants": 6, "killed": 4, "explained": 1, "survived": 1}
    assert row == {"file": "half.py", **counts, "killed_percent": 66.7}
    said = capsys.readouterr().out
    assert "half.py:2: return x / 2.75\n    a tenth is nothing\n" in said
    assert "half.py:2: return x - 2.5\n    SURVIVED" in said
    assert (tmp_path / "half.py").read_text() == CODE


def test_tests_that_fail_without_a_change_are_no_measure(tmp_path: Path) -> None:
    with pytest.raises(SystemExit, match=r"the tests of half\.py fail without a change"):
        mutants.judged(SUBJECT, project(tmp_path, 3.0), 100)


def test_explanations_are_of_files_that_are_tested() -> None:
    assert set(EXPLAINED) <= {subject.file for subject in SUBJECTS}
    assert all((mutants.ROOT / subject.file).is_file() for subject in SUBJECTS)
