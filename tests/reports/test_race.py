"""The race: what counts as reached, how runs are summed up, and a whole small race that is interrupted."""

import dataclasses
import math
from pathlib import Path

import pytest

from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import STEPPING
from sarah.episode.workers import Workers
from sarah.errors import RunFolderError
from sarah.reports import race as race_module
from sarah.reports.race import (
    RaceCurve,
    as_markdown,
    entries_of,
    episodes_until,
    interquartile_mean,
    is_run,
    race,
    rankings,
    run_entry,
)
from sarah.runs.config import TrainingConfig
from sarah.runs.journal import Journal
from sarah.runs.run_folder import RunFolder

TINY = TrainingConfig(episodes=10, slots=1, episode=EpisodeConfig(time_limit=1.5))


def curve(algo: str, *scores: float) -> RaceCurve:
    return RaceCurve(algo, tuple(5 * (index + 1) for index in range(len(scores))), scores, seconds=1.0)


def test_a_score_counts_once_it_is_held() -> None:
    assert episodes_until(curve("naf", 0.2, 0.9, 0.3, 0.9, 0.9, 0.9), 0.8) == 20
    assert episodes_until(curve("naf", 0.9, 0.9, 0.9), 0.8) == 5
    assert math.isinf(episodes_until(curve("naf", 0.2, 0.9, 0.9), 0.8))


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
    assert rankings([good], best_known=2.0)[0].reached == {0.9: 0, 0.95: 0}


def test_a_race_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entries = entries_of(("naf", "random"), range(1), TINY, 2, tmp_path)
    begun = RunFolder.create(tmp_path / "random-s0.unfinished", entries[1].config)  # and killed
    begun.append_recommendation(5, dict.fromkeys(STEPPING.parameter_names, 9.0))
    curves = race(entries, Workers())
    assert not begun.path.exists()
    assert [one.algo for one in curves] == ["naf", "random"] and all(map(is_run, entries))
    run = RunFolder.open(entries[0].folder)
    assert curves[0].episodes == (5, 10, 10)
    specs = [EpisodeSpec(run.parameters(), seed, config=TINY.episode) for seed in range(2)]
    assert curves[0].scores[-1] == pytest.approx(sum(simulate(spec).score for spec in specs) / 2)

    third = EpisodeSpec(run.parameters(), 2, config=TINY.episode)
    monkeypatch.setattr(race_module, "run_entry", lambda entry: pytest.fail("it is there already"))
    assert race(entries, Workers()) == curves
    monkeypatch.undo()
    monkeypatch.setattr(race_module, "train", lambda config, run: pytest.fail("it is trained already"))
    (more,) = race([dataclasses.replace(entries[0], evaluations=3)], Workers())
    assert more.seconds == curves[0].seconds and more.episodes == (5, 10, 10)
    assert 3 * more.scores[-1] == pytest.approx(2 * curves[0].scores[-1] + simulate(third).score)

    other = [dataclasses.replace(entries[0], config=dataclasses.replace(TINY, episodes=11))]
    with pytest.raises(RunFolderError, match="other settings"):
        race(other, Workers())


def test_a_race_removes_nobody_elses_run(tmp_path: Path) -> None:
    precious = tmp_path / "naf-s0" / "parameters.json"
    precious.parent.mkdir()
    precious.write_text("{}")
    with pytest.raises(RunFolderError, match="is not of a race"):
        race(entries_of(("naf",), range(1), TINY, 1, tmp_path), Workers())
    assert precious.read_text() == "{}"


def test_a_race_leaves_a_training_alone_that_another_is_at(tmp_path: Path) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, 1, tmp_path)
    begun = RunFolder.create(tmp_path / "random-s0.unfinished", entry.config)
    with (
        Journal(begun.journal_path, entry.config, Workers()),
        pytest.raises(RunFolderError, match="in use by another training"),
    ):
        run_entry(entry)
    assert begun.config() == entry.config
