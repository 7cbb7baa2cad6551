"""The folder of a training: its tables, its parameters, the episodes to choose from, and what is told of an episode."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from interrupted import EPISODE
from laboratory import COARSE_PHYSICS

from sarah import BALANCE, STEPPING, BalanceConfig, EpisodeConfig, EpisodeSpec, Push, PushedConfig, simulate
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.workers import Workers, begin_episode, finish_episode
from sarah.errors import ConfigurationError, RunFolderError
from sarah.recorded.folder import new_path
from sarah.robot.dimensions import dimensions_alike
from sarah.runs.config import TrainingConfig
from sarah.runs.episode_words import changed_settings, differences, told_of, told_settings
from sarah.runs.recorded_episodes import RecordedEpisodes
from sarah.runs.run_episodes import choose_episode, episode_of_parameters, episodes_of_run
from sarah.runs.run_folder import RunFolder
from sarah.runs.run_record import RunRecord
from sarah.simulation.terrain import Terrain, draw_terrain

CONFIG = TrainingConfig(algo="random", episodes=3, slots=1, episode=EPISODE)
SPECS = [EpisodeSpec((1.0, 0.5, 0.2, 1.0, share), seed, config=EPISODE) for seed, share in ((7, 0.5), (8, 1.5))]
LEARNED = {"P5": 0.5, "P2": 0.2, "P1": 0.1, "P4": 0.4, "P3": 0.3}


@pytest.fixture
def run(tmp_path: Path) -> RunFolder:
    """A training of two episodes, which names its learned parameters in another order."""
    folder = RunFolder.create(tmp_path / "run", CONFIG)
    for index, spec in enumerate(SPECS):
        folder.append_episode(index, spec, simulate(spec))
    folder.append_recommendation(2, LEARNED)
    folder.write_parameters({"parameters": LEARNED})
    return folder


def test_tables_say_what_was_written(run: RunFolder) -> None:
    record = RunRecord(RunFolder.open(run.path))
    assert record.config == CONFIG and record.learned == (0.1, 0.2, 0.3, 0.4, 0.5)
    results = [simulate(spec) for spec in SPECS]
    expected = {"return": [result.episode_return for result in results], "P5": [0.5, 1.5], "seed": [7.0, 8.0]}
    assert record.columns(record.episodes, list(expected)) == expected
    (row,) = record.recommendations
    assert row["episodes"] == "2" and row["P3"] == "0.3"
    with pytest.raises(RunFolderError, match=r"the episodes of .*run cannot be read: KeyError"):
        record.columns(record.episodes, ["nothing"])


def test_progress_gets_more_columns_and_records_go(run: RunFolder) -> None:
    run.append_progress(["b"], {"b": 1})
    run.widen_progress(["b", "a"])
    run.append_progress(["b", "a"], {"a": 2})
    assert (run.path / "progress.csv").read_text().split() == ["b,a", "1,", ",2"]
    run.remove_records()
    assert not list(run.episodes()) and not list(run.recommendations()) and run.is_finished


def test_its_episodes_are_there_to_choose_from(run: RunFolder) -> None:
    learned, best, *both = episodes_of_run(run)
    assert learned.spec == EpisodeSpec((0.1, 0.2, 0.3, 0.4, 0.5), 0, config=EPISODE)
    assert [episode.spec for episode in both] == SPECS and [episode.name for episode in both] == ["0", "1"]
    assert best.name == "best" and best.score == max(episode.score for episode in both)  # type: ignore[type-var]
    assert both[0].score == simulate(SPECS[0]).score and f"score {both[0].score:.2f}" in both[0].label
    assert best.spec in SPECS and both[1].of(SPECS[1]) is both[1] and both[1].of(SPECS[0]).score is None
    episodes = [learned, best, *both]
    assert choose_episode(episodes, None) is learned and choose_episode(episodes, "1") is both[1]
    with pytest.raises(ConfigurationError, match=r"unknown episode '2' \(allowed: learned, best, 0 to 1\)"):
        choose_episode(episodes, "2")
    run.result_path.unlink()  # as long as it learns
    assert [episode.name for episode in episodes_of_run(run)] == ["best", "0", "1"]


def test_without_episodes_there_is_nothing_to_show(run: RunFolder) -> None:
    run.remove_records()
    assert [episode.name for episode in episodes_of_run(run)] == ["learned"]
    run.result_path.unlink()
    with pytest.raises(RunFolderError, match="has no episodes to show yet"):
        episodes_of_run(run)


def test_given_parameters_are_an_episode() -> None:
    assert episode_of_parameters((0.5,) * 5).spec == EpisodeSpec((0.5,) * 5, 0, STEPPING)
    assert episode_of_parameters((0.5,) * 4).spec == EpisodeSpec((0.5,) * 4, 0, BALANCE)
    both = episode_of_parameters((0.5,) * 5 + (0.25,) * 4).spec
    assert both.parameters == (0.25,) * 4 and both.config.stepping == (0.5,) * 5  # type: ignore[attr-defined]
    words = r"must be 5 numbers \(P1 to P5\) or 4 numbers \(V1 to V4\) or all 9, not 3$"
    with pytest.raises(ConfigurationError, match=words):
        episode_of_parameters((0.5,) * 3)
    with pytest.raises(ConfigurationError, match=r"must be 5 numbers \(P1 to P5\), not 9$"):
        episode_of_parameters((0.5,) * 9, STEPPING)


def test_a_run_has_no_more_rows_than_episodes(run: RunFolder) -> None:
    run.append_episode(2, SPECS[0], simulate(SPECS[0]))
    assert len(list(run.episodes())) == 3
    run.append_episode(3, SPECS[0], simulate(SPECS[0]))
    with pytest.raises(RunFolderError, match=r"episodes.csv cannot be read: it has more than 4 lines"):
        list(run.episodes())


def test_folders_without_a_finished_training_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(RunFolderError, match="does not exist"):
        RunFolder.open(tmp_path / "nowhere")
    RunFolder.create(tmp_path / "begun", CONFIG)
    with pytest.raises(RunFolderError, match=r"no parameters.json"):
        RunFolder.open(tmp_path / "begun")
    assert RunFolder.open(tmp_path / "begun", unfinished=True).config() == CONFIG
    monkeypatch.chdir(tmp_path)
    assert [new_path("stepping", "naf-s3").name for _ in range(2)] == ["naf-s3", "naf-s3-2"]
    assert new_path("stepping", "naf-s3").parent == Path("runs/stepping")


def test_spoilt_parameters_are_named(run: RunFolder) -> None:
    text = '{"parameters": {"P1": "x", "P2": 1, "P3": 1, "P4": 1, "P5": 1}}'
    for content in ("{", "[]", "{}", '{"parameters": {"P1": 1}}', text):
        run.result_path.write_text(content)
        with pytest.raises(RunFolderError, match=r"parameters.json does not hold learned parameters"):
            run.parameters()


EPISODES = [(begin_episode, [3]), (finish_episode, [3]), (finish_episode, [3, 4]), (simulate, [3])]


@pytest.mark.parametrize(("function", "seeds"), EPISODES)
def test_the_journal_gives_back_every_bit(function: Callable[..., Any], seeds: list[int], tmp_path: Path) -> None:
    run = RunFolder.create(tmp_path / "run", CONFIG)
    config = EpisodeConfig(time_limit=2.0, physics=COARSE_PHYSICS)
    specs = [EpisodeSpec(PAPER_STEPPING, seed, config=config) for seed in seeds]
    with run.journal_of(CONFIG) as journal:
        simulated = RecordedEpisodes(journal, Workers()).submit(function, *specs).result()
    with run.journal_of(CONFIG) as journal:
        assert journal.replaying
        known = RecordedEpisodes(journal, Workers()).submit(function, *specs).result()
        assert not journal.replaying
    assert repr(known) == repr(simulated) and type(known) is type(simulated)


SPEC = EpisodeSpec((1.0, 0.0, 1.0, 0.0), 5, BALANCE, BalanceConfig(time_limit=1.5, push=Push(40.0, 90.0, 1.2)))
UNPUSHED = replace(BALANCE.episode, push=Push(0.0))


def test_the_pushes_of_the_trace_are_told() -> None:
    trace = simulate(SPEC, record_trace=True).trace
    assert trace is not None
    assert told_of(SPEC, trace) == ["push of 40 N forward at 1.20 s", "time_limit 1.5"]
    still = replace(trace, push=0.0 * trace.push)
    assert told_of(SPEC, still) == ["time_limit 1.5"]  # it ended before its push


DIMENSIONS, WIDER = dimensions_alike(1.1, 1.0), {"torso_width": 0.3, "sole_half_width": 0.06}


@pytest.mark.parametrize(
    ("settings", "told"),
    [
        ({}, []),
        ({"payload": 5.0}, ["payload 5"]),
        ({"dimensions": WIDER}, ["dimensions torso_width 0.3, sole_half_width 0.06"]),
        (UNPUSHED.for_robot(DIMENSIONS).__dict__, [f"{len(DIMENSIONS)} dimensions of its own"]),
        ({"stepping": (0.4, 1.3, 0.1, 1.0, 1.0)}, ["P1 to P5 0.40, 1.30, 0.10, 1.00, 1.00"]),
        ({"terrain": Terrain(friction_left=(0.2, 0.2))}, ["terrain.friction_left 0.2"]),
        ({"terrain": Terrain(roughness=0.01, reach=0.9)}, ["terrain.roughness 0.01", "terrain.reach 0.9"]),
    ],
)
def test_settings_that_differ_are_told(settings: Any, told: list[str]) -> None:
    changed = replace(UNPUSHED, **settings)
    assert told_settings(EpisodeSpec(SPEC.parameters, 5, BALANCE, changed)) == told
    assert told_settings(EpisodeSpec(PAPER_STEPPING, 0)) == []


def test_what_an_option_changes_has_both_values() -> None:
    changed = replace(UNPUSHED, payload=3.0, stepping=(0.5, 1.0, 0.0, 1.0, 1.0))
    other = replace(UNPUSHED, stepping=(0.5, 1.0, 0.0, 1.0, 0.75))
    stepping = "stepping 0.5, 1, 0, 1, 1 instead of 0.5, 1, 0, 1, 0.75"
    assert list(differences(changed, other)) == ["payload 3 instead of 0", stepping]
    assert list(differences(PushedConfig(push=UNPUSHED.push), UNPUSHED)) == []  # only one of both has P1 to P5


def test_a_special_setting_that_was_not_kept_has_both_values() -> None:
    for payload, of_subject, words in (
        *((0.0, 0.0, []), (3.0, 0.0, ["payload 3"]), (3.0, 3.0, ["payload 3"])),
        *((3.0, 5.0, ["payload 3 instead of 5"]), (0.0, 5.0, ["payload 0 instead of 5"])),
    ):
        subject = replace(BALANCE.episode, payload=of_subject)
        assert list(changed_settings(BALANCE, replace(subject, payload=payload), subject)) == words


def test_the_ground_is_told_as_the_seed_draws_it() -> None:
    ranges = Terrain(slope_degrees=(2.0, 8.0), roughness=(0.0, 0.02))
    told = told_settings(EpisodeSpec(PAPER_STEPPING, 5, config=EpisodeConfig(terrain=ranges)))
    names, drawn = ("slope_degrees", "direction_degrees", "roughness"), draw_terrain(ranges, 5)
    assert told == [f"terrain.{name} {getattr(drawn, name)[0]:.3g}" for name in names]
