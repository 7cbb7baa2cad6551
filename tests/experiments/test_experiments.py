"""Every experiment runs, in a size that takes seconds, and makes the columns that the pages expect."""

import dataclasses
import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest
from laboratory import need

from experiments import record
from experiments.__main__ import main, makes_the_result, mark_stale
from experiments.endurance.protections import PROTECTIONS, Protection
from experiments.maker import Maker, RowByRowExperiment
from experiments.made_with import made_with
from experiments.table import TABLE
from sarah.errors import ConfigurationError

LONG = {
    "killed_workers",
    "kills",
    "long_training",
    "mutants",
    "protections",
    "second_training",
    "throughput",
    "viewer",
}
"""Experiments that take more than some seconds in any size."""


@pytest.fixture(scope="module")
def workplace(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder for what several experiments share."""
    return tmp_path_factory.mktemp("workplace")


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.slow) if name in LONG else name for name in record.names()]
)
def test_an_experiment_makes_the_columns_of_its_result(
    name: str, workplace: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    need("pybullet")
    need("mujoco")
    if name == "viewer" and shutil.which("chromium") is None:
        pytest.skip("needs chromium")
    monkeypatch.chdir(workplace)
    main([name, "--quick", "--out", str(workplace)])
    made, published = record.read(name, workplace), record.read(name)
    assert made.columns == published.columns
    assert made.command == f"python -m experiments {name} --quick --out {workplace}"
    assert (made.made_with is None) == (published.made_with is None)


PENDING = {"balance_trainings", "ceiling", "second_training_summary", "shipping"}
"""Results whose rows take hours and are not made yet."""


def test_every_result_has_a_maker_and_every_maker_a_result() -> None:
    assert set(TABLE) - PENDING == set(record.names()) - PENDING


@pytest.mark.parametrize("name", record.names())
def test_a_result_answers_the_question_of_its_maker(name: str) -> None:
    assert record.read(name).question == TABLE[name].question


def test_without_a_name_all_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    main([])
    listed = capsys.readouterr().out
    assert all(name in listed and maker.question in listed for name, maker in TABLE.items())


def test_the_help_of_an_experiment_has_the_options_of_all_and_its_own(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as end:
        main(["clock", "--help"])
    shown = capsys.readouterr().out
    assert end.value.code == 0 and all(option in shown for option in ("--quick", "--out FOLDER", "--random-sets"))


def test_an_unknown_name_is_one_line_with_the_nearest() -> None:
    with pytest.raises(ConfigurationError, match=r"unknown experiment 'clok', did you mean 'clock'\?"):
        main(["clok"])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ("clock --random-sets 0", "--random-sets must be at least 1, not 0"),
        ("decisions --episodes 10 -1", "--episodes must be at least 1, not -1"),
        ("clock --workers -1", "--workers must be at least 0, not -1"),
        ("several_actions --algorithms NAF", "unknown algorithm 'NAF', did you mean 'naf'. .allowed: ddpg, naf, "),
        ("several_actions --tasks Hoper-v5", "unknown task 'Hoper-v5': .* Did you mean: `Hopper`"),
        ("hopper_actions --steps 35", "--steps must be a multiple of 10 evaluations .*, not 35"),
        ("hopper_actions --actions held", "unknown actions 'held' .allowed: as they are, held for four steps, "),
        ("scaled_actions --tasks six", "unknown task 'six' .*six actions, clear"),
        ("naf_pendulum --algorithms NAF", "unknown algorithm 'NAF', did you mean 'naf'. .allowed: ddpg, naf, "),
        ("scaled_actions --actions NAV", "unknown actions .NAV., did you mean .NAF."),
        (f"clock --out {__file__}", "--out must be a folder, and .* is a file"),
    ],
)
def test_a_mistake_is_one_line_before_anything_is_computed(arguments: str, said: str) -> None:
    with pytest.raises(ConfigurationError, match=said):
        main(arguments.split())


@dataclass(frozen=True)
class Squares(RowByRowExperiment):
    """Squares, of which one cannot be had at first.

    :param made: file that gets a line for each square that is computed
    :param fails_at: number whose square cannot be had
    """

    made: Path
    fails_at: int

    def keys(self) -> list[record.Row]:
        """Four numbers."""
        return [{"number": number} for number in range(4)]

    def row(self, number: int) -> record.Row:
        """A square."""
        if number == self.fails_at:
            raise KeyboardInterrupt
        self.made.write_text(f"{self.made.read_text()}{number}")
        return {"square": number * number}


def test_an_interrupted_experiment_goes_on_after_its_last_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (made := tmp_path / "made").touch()
    command = ["squares", "--out", str(tmp_path)]
    monkeypatch.setitem(TABLE, "squares", Maker("How large?", Squares(made, 2, workers=0), of_robot=False))
    with pytest.raises(KeyboardInterrupt):
        main(command)
    begun = record.read("squares", tmp_path)
    assert ([row["square"] for row in begun.rows], begun.missing) == (["0", "1"], 2)
    monkeypatch.setitem(TABLE, "squares", Maker("How large?", Squares(made, 9, workers=0), of_robot=False))
    main(command)
    whole = record.read("squares", tmp_path)
    assert ([row["square"] for row in whole.rows], whole.missing) == (["0", "1", "4", "9"], 0)
    assert made.read_text() == "0123"
    main(command)
    assert made.read_text() == "0123" * 2


def test_only_the_full_experiment_makes_the_result() -> None:
    clock = TABLE["clock"]
    assert makes_the_result(dataclasses.replace(clock.experiment, workers=0), clock.experiment)
    assert not makes_the_result(dataclasses.replace(clock.experiment, random_sets=100), clock.experiment)
    assert all(not makes_the_result(maker.quick_experiment, maker.experiment) for maker in TABLE.values())


def test_a_result_is_stale_only_for_a_reason() -> None:
    with pytest.raises(ConfigurationError, match="WHY must be a sentence"):
        main(["stale"])
    with pytest.raises(ConfigurationError, match=r"unknown result 'clok', did you mean 'clock'\?"):
        main(["stale", "The clock runs backwards.", "clok"])


def test_what_was_made_with_another_controller_becomes_stale(tmp_path: Path) -> None:
    others = made_with() | {"controller": "another"}
    record.write("outdated", [{"score": 1.0}], "How much?", "", others, tmp_path)
    record.write("todays", [{"score": 1.0}], "How much?", "", made_with(), tmp_path)
    record.write("of_no_robot", [{"score": 1.0}], "How much?", "", None, tmp_path)
    mark_stale(tmp_path, "The controller steps backwards.")
    stale = {name: record.read(name, tmp_path).stale for name in record.names(tmp_path)}
    assert stale == {"outdated": "The controller steps backwards.", "todays": None, "of_no_robot": None}
    mark_stale(tmp_path, "Robots are not concerned.", "of_no_robot")
    assert record.read("of_no_robot", tmp_path).stale == "Robots are not concerned."


@pytest.mark.parametrize("protection", PROTECTIONS, ids=lambda protection: protection.promise)
def test_a_protection_is_where_it_is_said_to_be(protection: Protection) -> None:
    """Whether its test fails without it, ``make endurance`` finds out."""
    assert (record.ROOT / "sarah" / protection.file).read_text(encoding="utf-8").count(protection.code) == 1
    assert protection.place.startswith("tests/")
