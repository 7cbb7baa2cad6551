"""The results that the documentation shows are of today's project, or say why not."""

import re
from pathlib import Path

import pytest

from experiments import record
from experiments.made_with import PROBES, differences, made_with

PAGES = sorted((record.ROOT / "docs").rglob("*.md"))
READS = re.compile(r"\{result-(?:table|figure)\} (\w+)|\{result\}`\w+ (\w+)")


@pytest.mark.parametrize("name", record.names())
def test_a_result_was_made_with_todays_physics_controller_and_robot(name: str) -> None:
    result = record.read(name)
    if result.made_with is None or result.stale is not None:
        return
    changed = differences(result.made_with, made_with())
    assert not changed, (
        f"results/{name}.csv was made with another {' and '.join(changed)} than today's: make results NAME={name} "
        f'makes it again; until then, python -m experiments stale "WHY" writes a sentence into results/{name}.json '
        "that its page shows"
    )


def test_every_table_of_results_says_how_it_was_made() -> None:
    rows, about = ({path.stem for path in record.RESULTS.glob(f"*.{suffix}")} for suffix in ("csv", "json"))
    without = rows ^ about
    assert not without, f"these stand in results/ with .csv or .json only: {', '.join(sorted(without))}"


def test_every_result_is_shown_on_a_page() -> None:
    shown = {name for page in PAGES for found in READS.findall(page.read_text(encoding="utf-8")) for name in found}
    assert not set(record.names()) - shown


@pytest.mark.parametrize("name", record.names())
def test_rows_have_as_many_cells_as_there_are_columns(name: str) -> None:
    result = record.read(name)
    assert result.rows
    assert all(None not in row and None not in row.values() for row in result.rows)
    assert result.question.endswith("?")


def fingerprint() -> dict:
    return {
        "physics": {"settings": "a", "pybullet": "b"},
        "controller": "c",
        "robot": "d",
        "probe": {"stepping, pybullet": [0.7, 0.0, 0.0, 0.85]},
    }


def test_what_a_change_is_of_is_named() -> None:
    then = fingerprint()
    assert differences(then, fingerprint()) == []
    assert differences(then, {**fingerprint(), "controller": "other"}) == ["controller"]
    physics = {"settings": "a", "pybullet": "other"}
    assert differences(then, {**fingerprint(), "physics": physics, "robot": "other"}) == ["physics", "robot"]


def test_an_episode_that_comes_out_otherwise_is_noticed_unless_it_is_a_matter_of_rounding() -> None:
    rounding = {"stepping, pybullet": [0.7 + 1e-9, 0.0, 0.0, 0.85]}
    other = {"stepping, pybullet": [0.701, 0.0, 0.0, 0.85]}
    assert differences(fingerprint(), {**fingerprint(), "probe": rounding}) == []
    assert differences(fingerprint(), {**fingerprint(), "probe": other}) == ["code of an episode"]


def test_an_engine_that_is_not_installed_is_not_compared() -> None:
    without = {**fingerprint(), "physics": {"settings": "a"}, "probe": {}}
    assert differences(fingerprint(), without) == []


def test_the_probe_asks_every_task() -> None:
    assert {episode.partition(",")[0] for episode in made_with()["probe"]} == set(PROBES)


def test_a_result_is_read_as_it_was_written(tmp_path: Path) -> None:
    rows = [{"run": "a, b", "score": 0.123456789, "episodes_to_90": float("inf"), "note": None}]
    record.write("some", rows, "How much?", "python -m experiments some", fingerprint(), tmp_path)
    result = record.read("some", tmp_path)
    assert result.rows == [{"run": "a, b", "score": "0.12346", "episodes_to_90": "inf", "note": ""}]
    assert result.made_with == fingerprint()
    assert result.stale is None
    record.mark_stale("some", "The controller has changed.", tmp_path)
    assert record.read("some", tmp_path).stale == "The controller has changed."
