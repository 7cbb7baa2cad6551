"""Endurance tests: they find what a weak test lets through, and what they name is there."""

from pathlib import Path

import pytest
from endurance import mutants
from endurance.mutants import EXPLAINED, SUBJECTS, Subject
from endurance.protections import PROTECTIONS, place_of
from pandas import DataFrame

from experiments import record
from experiments.found import ENDURANCE, find, paths_of
from experiments.making import make
from experiments.record import ROOT, ResultError

CODE = "def half(x):\n    return x / 2.5\n"


def judged(folder: Path, expected: float) -> record.Row:
    """Mutants of a function, with a test of its value at 4."""
    pytest.importorskip("cosmic_ray")
    (folder / "half.py").write_text(CODE)
    (folder / "test_half.py").write_text(
        f"from half import half\ndef test_half():\n    assert abs(half(4) - {expected}) < 0.3\n"
    )
    return mutants.judged("half.py", Subject("test_half.py"), folder, 100)


@pytest.mark.slow
@pytest.mark.parametrize("name", paths_of(ENDURANCE))
def test_an_endurance_test_makes_the_columns_of_its_result(name: str, tmp_path: Path) -> None:
    made = record.read(make(find(name), "python -m some", ["--quick", "--out", str(tmp_path)]).stem, tmp_path)
    assert list(made.rows[0]) == list(record.read(name).rows[0]) and not made.missing


@pytest.mark.slow
def test_what_the_tests_do_not_see_survives_with_its_line_or_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Within 0.3 of 4 / 2.5 lie 4 / 2.75 and 4 - 2.5, but not 4 / 3.5, 4 / 1.5, 4 + 2.5 or 4 * 2.5."""
    explained = [{"file": "half.py", "code": "return x / 2.75", "reason": "a tenth is nothing"}]
    monkeypatch.setattr(mutants, "EXPLAINED", DataFrame(explained))
    assert judged(tmp_path, 1.6) == {"mutants": 6, "killed": 4, "explained": 1, "survived": 1}
    said = capsys.readouterr().out
    assert "half.py:2: return x / 2.75\n    a tenth is nothing\n" in said
    assert "half.py:2: return x - 2.5\n    SURVIVED" in said
    assert (tmp_path / "half.py").read_text() == CODE


def test_tests_that_fail_without_a_change_are_no_measure(tmp_path: Path) -> None:
    with pytest.raises(ResultError, match=r"the tests of half\.py fail without a change"):
        judged(tmp_path, 3.0)


def test_explanations_are_of_files_that_are_tested() -> None:
    assert set(EXPLAINED.file) <= set(SUBJECTS)
    assert all((ROOT / file).is_file() for file in SUBJECTS)


@pytest.mark.parametrize("promise", PROTECTIONS)
def test_what_protects_is_there_once_and_has_its_test(promise: str) -> None:
    protection = PROTECTIONS[promise]
    assert (ROOT / "sarah" / protection["file"]).read_text(encoding="utf-8").count(protection["code"]) == 1
    assert place_of(protection["test"])
