"""Endurance tests: they find what a weak test lets through, and what they name is there."""

from pathlib import Path

import pytest
from endurance.mutants import EXPLAINED, SUBJECTS
from endurance.protections import PROTECTIONS, place_of

from experiments import record
from experiments.found import ENDURANCE, find, paths_of
from experiments.making import make
from experiments.record import ROOT


@pytest.mark.slow
@pytest.mark.parametrize("name", paths_of(ENDURANCE))
def test_an_endurance_test_makes_the_columns_of_its_result(name: str, tmp_path: Path) -> None:
    made = record.read(make(find(name), "python -m some", ["--quick", "--out", str(tmp_path)]).stem, tmp_path)
    assert list(made.rows[0]) == list(record.read(name).rows[0]) and not made.missing


def test_explanations_are_of_files_that_are_tested() -> None:
    assert set(EXPLAINED.file) <= set(SUBJECTS)
    assert all((ROOT / file).is_file() for file in SUBJECTS)


@pytest.mark.parametrize("promise", PROTECTIONS)
def test_what_protects_is_there_once_and_has_its_test(promise: str) -> None:
    protection = PROTECTIONS[promise]
    assert (ROOT / "sarah" / protection["file"]).read_text(encoding="utf-8").count(protection["code"]) == 1
    assert place_of(protection["test"])
