"""The race: what counts as reached, how runs are summed up, and a whole small race that is interrupted."""

import dataclasses
import math
import subprocess
import threading
import time
from concurrent.futures import ThreadPoolExecutor
from concurrent.futures import TimeoutError as FutureTimeoutError
from pathlib import Path
from typing import Any

import pytest
from laboratory import COARSE_PHYSICS
from terminal import BIN, COARSE

from sarah.episode.episode import simulate
from sarah.episode.evaluation import Evaluation
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.errors import ResumeError, RunFolderError
from sarah.files import locked
from sarah.reports import race as race_module
from sarah.reports.race import LOCK_FILE, RaceCurve, entries_of, is_run, race, read_curve, run_entry
from sarah.reports.rankings import as_markdown, episodes_until, interquartile_mean, rankings, write_csv
from sarah.runs import origin as origin_module
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.journal import Journal
from sarah.runs.run_folder import RunFolder

TINY = TrainingConfig(episodes=10, slots=1, episode=EpisodeConfig(time_limit=1.5, physics=COARSE_PHYSICS))


def curve(algo: str, *scores: float) -> RaceCurve:
    return RaceCurve(algo, tuple(5 * (index + 1) for index in range(len(scores))), scores, seconds=1.0)


def test_a_score_counts_once_it_is_held() -> None:
    assert episodes_until(curve("naf", 0.2, 0.9, 0.3, 0.9, 0.9, 0.9), 0.8) == 20
    assert episodes_until(curve("naf", 0.9, 0.9, 0.9), 0.8) == 5
    assert math.isinf(episodes_until(curve("naf", 0.2, 0.9, 0.9), 0.8))


def test_two_evaluations_after_the_same_episodes_are_one() -> None:
    """Without a comparison of candidates, the last recommendation is what was learned, and is evaluated twice."""
    assert math.isinf(episodes_until(RaceCurve("naf", (5, 10, 15, 15), (0.2, 0.9, 0.9, 0.9), 1.0), 0.8))


def test_counts_are_ones_after_which_there_was_a_recommendation(tmp_path: Path) -> None:
    early, late = curve("naf", 1, 1, 1, 1, 1, 1), curve("naf", 0, 0, 0, 1, 1, 1)
    (row,) = rankings([early, late])
    assert row.episodes == {0.9: 20.0, 0.95: 20.0}  # not 12.5, after which nobody was asked
    (row,) = rankings([early, late, early])
    assert row.episodes[0.9] == 5.0
    write_csv([row], tmp_path / "race.csv")
    assert (tmp_path / "race.csv").read_text().splitlines()[1].startswith("naf,3,5,3,5,3,")


def test_what_half_of_the_trainings_never_reach_is_not_reached(tmp_path: Path) -> None:
    good, bad = curve("naf", 1, 1, 1), curve("naf", 0, 0, 0)
    (row,) = rankings([good, bad])
    assert math.isinf(row.episodes[0.9]) and row.reached[0.9] == 1
    assert "| naf | 2 | not reached | 1 | not reached | 1 |" in as_markdown([row])
    write_csv([row], tmp_path / "race.csv")
    assert (tmp_path / "race.csv").read_text().splitlines()[1].startswith("naf,2,inf,1,inf,1,")


def test_an_algorithm_that_nobody_described_has_its_row() -> None:
    assert "- mine: nobody has said" in as_markdown(rankings([curve("mine", 0.1, 0.2)]))


def test_interquartile_mean_leaves_the_quarters_out() -> None:
    mean, low, high = interquartile_mean([0.0, 0.4, 0.6, 9.0])
    assert mean == pytest.approx(0.5) and low <= mean <= high
    assert interquartile_mean([0.7]) == pytest.approx((0.7, 0.7, 0.7))


def test_rankings_are_shares_of_the_best_final_score() -> None:
    good = curve("naf", 0.1, 0.78, 0.78, 0.8)
    slow = curve("td3", 0.1, 0.1, 0.74, 0.74, 0.74)
    never = curve("td3", 0.1, 0.1, 0.1, 0.1, 0.1)
    first, second = rankings([slow, good, never])
    assert (first.algo, second.algo) == ("naf", "td3")
    assert first.episodes == {0.9: 10.0, 0.95: 10.0} and first.reached == {0.9: 1, 0.95: 1}
    assert second.runs == 2 and second.reached == {0.9: 1, 0.95: 0}
    assert math.isinf(second.episodes[0.95])
    assert "| naf | 1 | 10 | 1 | 10 | 1 | 0.800 (0.800 to 0.800) | 1 s |" in as_markdown([first, second])
    assert "\n- naf: chosen on the tasks stepping and balance" in as_markdown([first, second])
    assert rankings([good], best_known=2.0)[0].reached == {0.9: 0, 0.95: 0}


def test_rewards_below_zero_have_shares_as_well() -> None:
    (row,) = rankings([curve("naf", -9.0, -1.09, -1.0, -1.0, -1.0)])
    assert row.episodes == {0.9: 10.0, 0.95: 15.0}


def test_the_origin_of_every_algorithms_settings_is_said() -> None:
    table = as_markdown(rankings([curve(algo, 0.1, 0.2) for algo in ALGORITHMS]))
    assert "- td3, sac, ddpg: set once by hand" in table and "- gp, tpe: the defaults of Optuna" in table


def test_a_race_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entries = entries_of(("naf", "random"), range(1), TINY, 2, tmp_path)
    curves = race(entries, Workers())
    assert [one.algo for one in curves] == ["naf", "random"] and all(map(is_run, entries))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["naf-s0", "random-s0"]
    run = RunFolder.open(entries[0].folder)
    assert curves[0].episodes == (5, 10, 10)
    specs = [EpisodeSpec(run.parameters(), seed, config=TINY.episode) for seed in range(2)]
    assert curves[0].scores[-1] == pytest.approx(sum(simulate(spec).score for spec in specs) / 2)

    third = EpisodeSpec(run.parameters(), 2, config=TINY.episode)
    monkeypatch.setattr(race_module, "run_entry", lambda *_: pytest.fail("it is there already"))
    assert race(entries, Workers()) == curves
    monkeypatch.undo()
    monkeypatch.setattr(race_module, "train", lambda *_, **__: pytest.fail("it is trained already"))
    (more,) = race([dataclasses.replace(entries[0], evaluations=3)], Workers())
    assert more.seconds == curves[0].seconds and more.episodes == (5, 10, 10)
    assert 3 * more.scores[-1] == pytest.approx(2 * curves[0].scores[-1] + simulate(third).score)

    other = [dataclasses.replace(entries[0], config=dataclasses.replace(TINY, episodes=11))]
    with pytest.raises(RunFolderError, match="naf-s0 is a training with episodes 10, not 11: name another folder"):
        race(other, Workers())


def test_a_race_does_not_mix_states_of_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (first, second) = entries_of(("random",), range(2), TINY, 2, tmp_path)
    monkeypatch.setattr(origin_module, "versions", lambda: {"sarah-sources": "another state"})
    finished = race([first], Workers())
    monkeypatch.undo()
    assert race([first], Workers()) == finished  # nothing new comes into the table
    for entries in ([first, second], [dataclasses.replace(first, evaluations=3)]):
        with pytest.raises(ResumeError, match=r"random-s0 cannot be resumed: .*sarah-sources is \w+ here, and another"):
            race(entries, Workers())
    assert not second.folder.exists()


def test_a_race_removes_nobody_elses_run(tmp_path: Path) -> None:
    precious = tmp_path / "naf-s0" / "parameters.json"
    precious.parent.mkdir()
    precious.write_text("{}")
    with pytest.raises(RunFolderError, match="is not of a race"):
        race(entries_of(("naf",), range(1), TINY, 1, tmp_path), Workers())
    assert precious.read_text() == "{}"


def test_a_race_leaves_a_training_alone_that_another_is_at(tmp_path: Path) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, 1, tmp_path)
    begun = RunFolder.create(tmp_path / "random-s0", entry.config)
    with (
        Journal(begun.journal_path, entry.config, Workers()),
        pytest.raises(RunFolderError, match="in use by another training"),
    ):
        run_entry(entry)
    assert begun.config() == entry.config


def test_an_evaluation_that_was_interrupted_is_all_that_is_repeated(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, 2, tmp_path)
    (whole,) = race([entry], Workers())
    (entry.folder / "race.csv").unlink()
    monkeypatch.setattr(race_module, "train", lambda *_, **__: pytest.fail("it is trained already"))
    assert race([entry], Workers()) == [whole]


def test_a_race_waits_for_another_that_is_at_the_same_training(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, 1, tmp_path)
    begun, may_end = threading.Event(), threading.Event()
    evaluate = race_module.evaluate

    def slow(*arguments: Any) -> Evaluation:
        begun.set()
        assert may_end.wait(60)
        return evaluate(*arguments)

    monkeypatch.setattr(race_module, "evaluate", slow)
    with ThreadPoolExecutor(2) as pool:
        first = pool.submit(run_entry, entry)
        assert begun.wait(60)
        monkeypatch.setattr(race_module, "train", lambda *_, **__: pytest.fail("it is trained already"))
        second = pool.submit(run_entry, entry)
        with pytest.raises(FutureTimeoutError):
            second.result(0.3)
        may_end.set()
        first.result(60)
        second.result(60)
    assert read_curve(entry).episodes == (5, 10, 10)


RACE = f"--algorithms random --seeds 1 --episodes 30 --evaluations 2 --episode.time-limit 2 {' '.join(COARSE)}"


def begin(folder: Path) -> subprocess.Popen[str]:
    command = [BIN / "sarah-compare", "race", *RACE.split()]
    return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=folder)


def wait_for_rows(process: subprocess.Popen[str], journal: Path, count: int) -> None:
    while not journal.exists() or journal.read_bytes().count(b"\n") < count:
        assert process.poll() is None, process.communicate()
        time.sleep(0.01)


def test_a_killed_race_resumes_and_two_races_at_once_share_the_work(tmp_path: Path) -> None:
    run = tmp_path / "race" / "random-s0"
    journal = run / "journal.jsonl"
    first = begin(tmp_path)
    wait_for_rows(first, journal, 10)
    first.kill()
    first.communicate()
    kept, earlier = journal.read_bytes(), float((run / "race_seconds.txt").read_text())
    assert earlier > 0.0 and not (run / "race.csv").exists()

    first, second = begin(tmp_path), begin(tmp_path)
    (told, errors), (also_told, other_errors) = first.communicate(timeout=100), second.communicate(timeout=100)
    assert first.returncode == second.returncode == 0, errors + other_errors
    assert told == also_told and "| random | 1 |" in told

    episode = EpisodeConfig(time_limit=2.0, physics=COARSE_PHYSICS)
    config = TrainingConfig(algo="random", episodes=30, slots=1, episode=episode)
    (entry,) = entries_of(("random",), range(1), config, 2, tmp_path / "undisturbed")
    (undisturbed,) = race([entry], Workers())
    for name in ("episodes.csv", "recommendations.csv", "parameters.json", "journal.jsonl"):
        assert (run / name).read_bytes() == (entry.folder / name).read_bytes(), name  # no row is there twice
    assert journal.read_bytes().startswith(kept[: kept.rindex(b"\n") + 1])
    found = read_curve(dataclasses.replace(entry, folder=run))
    assert found.scores == undisturbed.scores and found.seconds > earlier


def test_a_race_leaves_out_what_another_is_at_and_waits_for_it_at_its_end(tmp_path: Path) -> None:
    entries = entries_of(("random", "cma-es"), range(2), TINY, 1, tmp_path)
    busy, *others = entries
    RunFolder.create(busy.folder, busy.config)
    curves: list[RaceCurve] = []
    second = threading.Thread(target=lambda: curves.extend(race(entries, Workers())))
    with locked(busy.folder / LOCK_FILE):
        second.start()
        deadline = time.monotonic() + 60.0
        while not all(map(is_run, others)) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert all(map(is_run, others)) and not is_run(busy) and not curves
    second.join(60.0)
    assert is_run(busy) and [curve.algo for curve in curves] == ["random", "cma-es"] * 2


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("race.csv", "episodes,score,seconds,evaluations\n" + 50 * "5,0.5,1,1\n"),
        ("race.csv", "episodes,score,seconds,evaluations\n5,x,1,1\n"),
        ("race.csv", "x" * 100_000),
        ("race.csv", ""),
        ("recommendations.csv", "episodes\nx\n"),
    ],
)
def test_damaged_tables_are_named(name: str, content: str, tmp_path: Path) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, 1, tmp_path)
    race([entry], Workers())
    (entry.folder / name).write_text(content)
    with pytest.raises(RunFolderError, match=r"random-s0.* cannot be read") as raised:
        race([entry if name == "race.csv" else dataclasses.replace(entry, evaluations=2)], Workers())
    assert len(str(raised.value).splitlines()) == 1
