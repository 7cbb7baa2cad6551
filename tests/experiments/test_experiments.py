"""Every experiment runs, in a size that takes seconds, and makes the columns that the pages expect."""

import dataclasses
import subprocess
from collections.abc import Iterator
from contextlib import nullcontext
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from endurance.mutants import EXPLAINED, SUBJECTS
from endurance.protections import PROTECTIONS, place_of
from laboratory import need
from pytest import CaptureFixture, MonkeyPatch

from experiments import record
from experiments.command import age, main
from experiments.experiment import Experiment, product
from experiments.found import BENCHMARKS, ENDURANCE, EXPERIMENTS, find, paths_of, questions, sources
from experiments.making import make
from experiments.record import ROOT, Result, Row
from sarah.errors import ConfigurationError, SarahError


@dataclass(frozen=True)
class Squares(Experiment):
    """Squares of some numbers."""

    workers: int = 0
    count: int = 3
    fails_at: int | None = None  # number at which the power fails

    @property
    def options(self) -> str:
        return super().options.partition(", fails_at")[0]  # a failure is none

    def cases(self) -> list[Row]:
        return product(kind=["whole"], number=range(self.count))

    def rows(self, kind: str, number: int) -> Iterator[Row]:
        if number == self.fails_at:
            raise KeyboardInterrupt
        yield {"sign": 1, "square": float(number**2)}
        yield {"sign": -1, "square": -float(number**2)}


def squares(full: Squares) -> Any:
    doc = "How large are squares?\n\nLarge."
    return SimpleNamespace(__name__="some.squares", __doc__=doc, FULL=full, QUICK=Squares(count=1))


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("workplace")


def check_columns(name: str) -> None:
    """Compute the first and the last case, of which each has the columns of the result."""
    need("pybullet")
    need("mujoco")
    module = find(name)
    cases = module.QUICK.cases()
    known = list(record.read(name).rows[0]) if name in record.names() else None
    for case in (cases[0], cases[-1])[: len(cases)]:
        for row in module.QUICK.rows(**case):
            assert known in (None, list(case | row))


@pytest.mark.parametrize("name", paths_of(EXPERIMENTS))
def test_an_experiment_makes_the_columns_of_its_result(name: str, workplace: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.chdir(workplace)
    check_columns(name)


@pytest.mark.parametrize("name", sorted(paths_of(BENCHMARKS).keys() - {"throughput", "viewer"}))
def test_a_timing_makes_the_columns_of_its_result(name: str) -> None:
    """The two that are left out take workers and a browser."""
    check_columns(name)


def test_every_result_answers_the_question_of_an_experiment() -> None:
    assert set(record.names()) <= set(paths_of())
    asked = questions()
    assert [name for name in record.names() if record.read(name).question != asked[name]] == []


def test_without_a_name_all_are_listed(capsys: CaptureFixture[str]) -> None:
    main(EXPERIMENTS, [])
    listed = capsys.readouterr().out
    assert "first_training" in listed and "Does the robot learn to step" in listed


MISTAKES = {
    ("firts_training",): r"unknown experiment 'firts_training', did you mean 'first_training'\?",
    ("first_training", "--only", "sed=3"): "KEY=VALUE; unknown key 'sed'",
    ("first_training", "--only", "run=naf seed 2299"): r"unknown run 'naf seed 2299', did you mean 'naf seed 229'\?",
    ("first_training", "--seeds", "0"): "--seeds must be at least 1, not 0",
    ("age", "first_training"): "age takes no arguments, not 'first_training'",
}


@pytest.mark.parametrize("arguments", MISTAKES)
def test_wrong_options_are_named(arguments: tuple[str, ...]) -> None:
    with pytest.raises(ConfigurationError, match=MISTAKES[arguments]):
        main(EXPERIMENTS, list(arguments))


def made(folder: Path, full: Squares, *options: str, command: str = "run squares") -> Result:
    """What is made of squares; a power failure ends it early."""
    with nullcontext() if full.fails_at is None else pytest.raises(KeyboardInterrupt):
        make(squares(full), command, [*options, "--out", str(folder)])
    return record.read("squares", folder)


def test_what_was_interrupted_goes_on(tmp_path: Path) -> None:
    begun = made(tmp_path, Squares(fails_at=2))
    assert len(begun.rows) == 4 and begun.missing == 1
    (tmp_path / "squares.csv").write_text((tmp_path / "squares.csv").read_text().replace(",-1,-1", ",-1,-7"))
    whole = made(tmp_path, Squares(), "--workers", "0")
    assert [row["square"] for row in whole.rows] == ["0", "-0", "1", "-7", "4", "-4"] and not whole.missing


def test_a_complete_result_stays_until_the_new_one_is(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr("experiments.making.OTHER_RESULTS", tmp_path / "other")
    whole = made(tmp_path, Squares())
    assert made(tmp_path, Squares(fails_at=1)) == whole
    (begun,) = (tmp_path / "other" / "unfinished").iterdir()
    begun.write_text(begun.read_text().replace("0,1,0", "0,1,-7"))
    again = made(tmp_path, Squares())
    assert [row["square"] for row in again.rows] == ["-7", "-0", "1", "-1", "4", "-4"] and not again.missing
    assert not begun.exists()


def test_what_is_there_and_how_long_the_rest_takes_is_said(
    tmp_path: Path, monkeypatch: MonkeyPatch, capsys: CaptureFixture[str]
) -> None:
    known = dataclasses.replace(made(tmp_path, Squares()), minutes=30.0)
    record.write(known, tmp_path)
    monkeypatch.setattr(record.names, "__defaults__", (tmp_path,))
    monkeypatch.setattr(record.read, "__defaults__", (tmp_path,))
    made(tmp_path / "other", Squares(fails_at=1))
    said = capsys.readouterr().err
    assert "that takes about 30 minutes with one worker" in said
    assert f"complete cases are in {tmp_path / 'other' / 'squares.csv'}, and the same command goes on" in said
    made(tmp_path / "other", Squares())
    assert "goes on: 1 of 3 cases are there\nthat takes a minute or less" in capsys.readouterr().err


def test_rows_of_before_keep_what_their_head_says(tmp_path: Path) -> None:
    begun = made(tmp_path, Squares(fails_at=1))
    record.write(dataclasses.replace(begun, tree="dirty", remark="Squares were rounder."), tmp_path)
    whole = made(tmp_path, Squares())
    assert (whole.tree, whole.remark, len(whole.rows)) == ("dirty", "Squares were rounder.", 6)


def test_rows_are_made_at_several_commits_and_machines(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    """The file is what a commit brings to another machine, where the project and its packages are newer."""
    full = Squares(fails_at=1)
    for number, torch in enumerate(("2.12", "2.13", "2.13"), start=1):
        monkeypatch.setattr(record, "commit", lambda number=number: f"commit{number}")
        monkeypatch.setattr("experiments.making.versions", lambda torch=torch: {"python": "3.11", "torch": torch})
        result = made(tmp_path, full)
        assert result.commit.split() == [f"commit{one}" for one in range(1, number + 1)]
        full = Squares(fails_at=2) if number == 1 else Squares()
    assert [row["number"] for row in result.rows] == ["0", "0", "1", "1", "2", "2"] and not result.missing
    assert result.versions == "python 3.11, torch 2.12 and 2.13"
    assert result.made_at.startswith("Made at commit1, commit2 and commit3 on ")


def test_another_command_begins_anew_and_cases_can_be_chosen(tmp_path: Path) -> None:
    for words in ("run squares", "run other squares"):
        begun = made(tmp_path, Squares(fails_at=1), command=words)
    assert begun.command.startswith("run other squares")
    assert [row["number"] for row in made(tmp_path / "some", Squares(), "--only", "number=2").rows] == ["2", "2"]


def test_a_changed_experiment_does_not_go_on_with_rows_of_the_former(tmp_path: Path) -> None:
    begun = made(tmp_path, Squares(fails_at=2))
    assert begun.options == "count=3"
    assert [row["number"] for row in made(tmp_path, Squares(count=2)).rows] == ["0", "0", "1", "1"]


def test_rows_of_cases_that_an_experiment_no_longer_has_go(tmp_path: Path) -> None:
    path = tmp_path / "squares.csv"
    made(tmp_path, Squares(fails_at=2))
    path.write_text(path.read_text().replace("whole,1,", "half,1,"))
    assert [row["number"] for row in made(tmp_path, Squares()).rows] == ["0", "0", "1", "1", "2", "2"]


NO_RESULTS = {
    "question": "missing 1 required positional argument: 'question'",
    "colour": "got an unexpected keyword argument 'colour'",
    "missing": "invalid literal",
    "cells": "a row has more or fewer cells than columns: whole",
    "letters": "can't decode byte",
}


@pytest.mark.parametrize("fault", NO_RESULTS)
def test_what_is_no_result_is_said_in_a_line(fault: str, tmp_path: Path) -> None:
    head = b"# question: How large?\n# command: run\n# commit: unknown\n# date: 2026-01-02\n"
    rows = b"kind,number\nwhole,1\n"
    content = {
        "question": head.partition(b"\n")[2] + rows,
        "colour": head + b"# colour: red\n" + rows,
        "missing": head + b"# missing: some\n" + rows,
        "cells": (head + rows)[:-3],
        "letters": head + rows + b"\xff,1\n",
    }
    (tmp_path / "squares.csv").write_bytes(content[fault])
    with pytest.raises(record.ResultError, match=rf"squares[.]csv is no result: .*{NO_RESULTS[fault]}"):
        record.read("squares", tmp_path)


def test_a_result_depends_on_its_experiment_and_on_those_that_this_takes_from() -> None:
    files = {Path(file).stem for file in sources("second_training")}
    assert files == {"second_training", "best_known", "balance_trainings", "conditions"}


def test_a_new_module_is_a_change(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    subprocess.run(["git", "init", "-q", str(tmp_path)], check=True)
    monkeypatch.setattr(record, "ROOT", tmp_path)
    for path in (tmp_path / "new.py", tmp_path / "results" / "some.csv"):
        path.parent.mkdir(exist_ok=True)
        path.touch()
    assert record.changed_files() == ["new.py"]


def test_only_the_full_experiment_of_committed_code_makes_it(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(record, "RESULTS", tmp_path / "results")
    monkeypatch.setattr("experiments.making.OTHER_RESULTS", tmp_path / "other")
    monkeypatch.setattr(record, "changed_files", lambda: ["sarah/files.py"])
    with pytest.raises(SarahError, match=r"made of, or put it elsewhere: sarah/files[.]py has changes"):
        make(squares(Squares()), "run squares", [])
    assert not list(tmp_path.iterdir())
    monkeypatch.setattr(record, "changed_files", list)
    for options in (["--workers", "0"], ["--count", "2"], ["--only", "number=1"], ["--quick"]):
        path = make(squares(Squares()), "run squares", options)
        assert (path.parent.name == "results") == (options[0] == "--workers")


def test_an_unpacked_archive_cannot_tell_its_commit(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.setattr(record, "ROOT", tmp_path)
    assert record.commit() == "unknown"
    result = Result("some", "How much?", "run some", "0123abc", "2026-01-02")
    assert age(result, ("sarah",)) == "cannot tell without the whole history"


def test_a_result_is_read_as_it_was_written(tmp_path: Path) -> None:
    row: dict[str, Any] = {"run": "a, b # c", "score": 0.123456789, "episodes_to_90": float("inf"), "note": None}
    about = Result("some", "How much: all?", "run some", "unknown", "2026-01-02", 1.5, versions="python 3, sarah 1")
    record.write(dataclasses.replace(about, rows=[row]), tmp_path)
    result = record.read("some", tmp_path)
    assert result.rows == [{"run": "a, b # c", "score": "0.12346", "episodes_to_90": "inf", "note": ""}]
    assert dataclasses.replace(result, rows=()) == about
    assert result.table.to_dict("records")[0]["score"] == 0.12346


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
