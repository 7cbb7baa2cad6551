"""Survival by force and direction: the same pushes for every controller, and honest intervals."""

import dataclasses
import math
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from laboratory import COARSE_PHYSICS, RESULT

from sarah.cli import eval as eval_command
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports import robustness
from sarah.reports.robustness import PushedEpisode, push_many, robustness_table, wilson_interval

FALL = dataclasses.replace(RESULT, score=0.1, termination="left_box", final_position=(0.3, 0.0, 0.8))


def pushed(degrees: float, result: EpisodeResult = RESULT, newtons: float = 100.0) -> PushedEpisode:
    return PushedEpisode(newtons, math.radians(degrees), result)


def test_controllers_meet_the_same_pushes_and_can_be_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robustness, "SECONDS_AFTER", 0.1)
    still, moving = push_many(
        [(0.0,) * 4, (1.0, 0.0, 1.0, 0.0)],
        BalanceConfig(physics=COARSE_PHYSICS, push=Push(sagittal_share=1.0)),  # they come from everywhere all the same
        Workers(),
        forces=(20.0, 40.0),
        episodes=2,
    )
    assert [e.newtons for e in still] == [20.0, 20.0, 40.0, 40.0]
    assert [e.radians for e in still] == [e.radians for e in moving]
    assert still[0].radians == pytest.approx(still[2].radians) != still[1].radians
    assert [e.result for e in still] != [e.result for e in moving]
    assert {e.result.duration for e in still} == {3.25}
    push = Push(newtons=(40.0, 40.0), at_seconds=robustness.PUSHED_BETWEEN)
    config = BalanceConfig(physics=COARSE_PHYSICS, push=push, time_limit=3.25)
    assert simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), 1, "balance", config)) == moving[3].result


def test_pushes_within_45_degrees_of_the_sides_are_lateral() -> None:
    assert [pushed(degrees).direction for degrees in (0, 40, -170, 179)] == ["lateral"] * 4
    assert [pushed(degrees).direction for degrees in (50, 90, -90, 130)] == ["sagittal"] * 4


def test_table_counts_by_direction() -> None:
    found = robustness_table([pushed(0), pushed(180, FALL), pushed(90), pushed(90), pushed(0, newtons=25.0)])
    table = {group: (evaluation.episodes, evaluation.survival_rate) for group, evaluation in found.items()}
    assert table == {
        (25.0, "all"): (1, 1.0),
        (25.0, "lateral"): (1, 1.0),
        (100.0, "all"): (4, 0.75),
        (100.0, "lateral"): (2, 0.5),
        (100.0, "sagittal"): (2, 1.0),
    }
    everything = found[100.0, "all"]
    assert everything.median("score") == 0.8 and everything.median("drift") == pytest.approx(0.05)


def test_wilsons_interval_is_the_published_one() -> None:
    assert wilson_interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)


@given(episodes=st.integers(1, 1000), data=st.data())
def test_interval_holds_the_share_and_is_never_empty(episodes: int, data: st.DataObject) -> None:
    survivors = data.draw(st.integers(0, episodes))
    low, high = wilson_interval(survivors, episodes)
    share = survivors / episodes
    assert 0.0 <= low <= share + 1e-12 and share - 1e-12 <= high <= 1.0 and high - low > 0.0


def test_eval_prints_the_table_and_leaves_it_with_a_plot(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    fallen = [pushed(degrees, FALL, newtons) for newtons in (50.0, 100.0) for degrees in range(0, 360, 45)]
    up = [dataclasses.replace(episode, result=RESULT) for episode in fallen]
    monkeypatch.setattr(robustness, "push_many", lambda *_, **__: [fallen, up])
    arguments = ["sarah-eval", "1,0,1,0", "--robustness", "--out", str(tmp_path / "out")]
    monkeypatch.setattr("sys.argv", arguments)
    eval_command.main()
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"robustness.md", "robustness.png", "robustness.pdf"}
    printed = capsys.readouterr().out
    assert (tmp_path / "out" / "robustness.md").read_text() in printed
    assert "score, drift, vibration: medians" in printed
    row = next(line for line in printed.splitlines() if line.startswith("| 100 N | all"))
    assert "| 8 | 0.00 (0.00 to 0.32)" in row and "1.00 (0.68 to 1.00)" in row
