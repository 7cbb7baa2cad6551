"""The race: a whole small one that is judged, interrupted and shared, and its files."""

import csv
import threading
import time
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from statistics import mean
from types import SimpleNamespace
from typing import Any

import pytest
from laboratory import COARSE_PHYSICS

from sarah import STEPPING, EpisodeConfig, EpisodeSpec, simulate
from sarah.episode.workers import Workers
from sarah.errors import ResumeError, RunFolderError
from sarah.files import locked
from sarah.recorded import folder as folder_module
from sarah.reports import race as race_module
from sarah.reports.judging import Evaluations
from sarah.reports.race import LOCK_FILE, TIME_FILE, race, run_entry
from sarah.reports.race_entry import RaceCurve, entries_of, is_evaluated
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder

ONCE = Evaluations(1, 1)
TINY = TrainingConfig(episodes=10, slots=1, episode=EpisodeConfig(time_limit=1.5, physics=COARSE_PHYSICS))


def test_a_race_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    entries = entries_of(("naf", "random"), range(1), TINY, Evaluations(3, 2), tmp_path)
    curves = race(entries, Workers())
    assert [one.algo for one in curves] == ["naf", "random"] and all(map(is_evaluated, entries))
    assert sorted(path.name for path in tmp_path.iterdir()) == ["naf-s0", "random-s0"]
    run = RunFolder.open(entries[0].folder)
    assert curves[0].episodes == (5, 10, 10)
    specs = [EpisodeSpec(run.parameters(), seed, config=TINY.episode) for seed in range(4)]
    judged = [simulate(spec).score for spec in specs]
    assert curves[0].final == tuple(judged[:3]) and curves[0].scores[-1] == mean(judged[:2])
    (*_, along, final) = csv.DictReader((entries[0].folder / "race.csv").open())
    assert (along["evaluations"], final["evaluations"]) == ("2", "3")
    assert float(final["score"]) == pytest.approx(mean(judged[:3]))

    monkeypatch.setattr(race_module, "run_entry", lambda *_: pytest.fail("it is there already"))
    assert race(entries, Workers()) == curves
    monkeypatch.undo()
    monkeypatch.setattr(race_module, "train", lambda *_, **__: pytest.fail("it is trained already"))
    (entries[1].folder / "race.csv").unlink()  # its evaluation was interrupted
    assert race(entries, Workers()) == curves
    (more,) = race([replace(entries[0], evaluations=Evaluations(4, 2))], Workers())
    assert more == replace(curves[0], final=tuple(judged))

    other = [replace(entries[0], config=replace(TINY, episodes=11))]
    with pytest.raises(RunFolderError, match="naf-s0 is a training with episodes 10, not 11: name another folder"):
        race(other, Workers())


@pytest.fixture
def met(monkeypatch: pytest.MonkeyPatch) -> list[tuple[float, int]]:
    """Judging episodes, as parameter and seed: no simulation, and a training that recommends 0.3, 0.4 and 0.4 again."""
    episodes: list[tuple[float, int]] = []

    def learn(config: TrainingConfig, run: RunFolder, **_: Any) -> None:
        for count, value in ((5, 0.3), (10, 0.4)):
            run.append_recommendation(count, dict.fromkeys(STEPPING.parameter_names, value))
        run.write_parameters({"parameters": dict.fromkeys(STEPPING.parameter_names, 0.4)})

    def judge(task: Any, parameters: tuple[float, ...], config: Any, seeds: Iterable[int]) -> Any:
        episodes.extend((parameters[0], seed) for seed in seeds)
        return SimpleNamespace(results=[SimpleNamespace(score=parameters[0] + 0.1 * seed) for seed in seeds])

    monkeypatch.setattr(race_module, "train", learn)
    monkeypatch.setattr(race_module, "evaluate", judge)
    return episodes


def test_what_is_recommended_again_is_judged_once(tmp_path: Path, met: list[tuple[float, int]]) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, Evaluations(3, 2), tmp_path)
    (found,) = race([entry], Workers())
    assert met == [(0.3, 0), (0.3, 1), (0.4, 0), (0.4, 1), (0.4, 2)]
    assert found.final == pytest.approx((0.4, 0.5, 0.6)) and found.scores == pytest.approx((0.35, 0.45, 0.45))
    scores = entry.folder / "race_scores.csv"
    for cut in ("", "seed,score\n0,0.5\n"):  # judged again, if it has not all scores of its episodes
        scores.write_text(cut) if cut else scores.unlink()
        assert race([entry], Workers()) == [found]


@pytest.mark.usefixtures("met")
def test_a_race_says_before_it_starts_what_there_is_to_do(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Also the ten unseen episodes that a training ends with."""

    def said(trainings: int, judging: int) -> str:
        to_do = f"{trainings} trainings to go, with at most 20 episodes together"
        return f"{to_do}; at most {judging} others judge what they recommend\n"

    entries = entries_of(("random",), range(2), TINY, Evaluations(2, 1), tmp_path)
    race(entries[:1], Workers(), progress_bar=True)
    shown = capsys.readouterr().err
    assert shown.startswith(said(1, 2 * 1 + 2)) and "1/1" in shown
    more = [replace(entry, evaluations=Evaluations(3, 1)) for entry in entries]
    race(more, Workers(), progress_bar=True)
    assert capsys.readouterr().err.startswith(said(2, 2 * (2 * 1 + 3)))
    race(more, Workers(), progress_bar=True)
    race([replace(entry, evaluations=Evaluations(4, 1)) for entry in entries], Workers())
    assert not capsys.readouterr().err


def test_a_race_does_not_mix_states_of_the_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (first, second) = entries_of(("random",), range(2), TINY, Evaluations(2, 1), tmp_path)
    monkeypatch.setattr(folder_module, "versions", lambda: {"sarah-sources": "another state"})
    finished = race([first], Workers())
    monkeypatch.undo()
    assert race([first], Workers()) == finished  # nothing new comes into the table
    for entries in ([first, second], [replace(first, evaluations=Evaluations(3, 1))]):
        with pytest.raises(ResumeError, match=r"random-s0 cannot be resumed: .*sarah-sources is \w+ here, and another"):
            race(entries, Workers())
    assert not second.folder.exists()


def test_a_race_leaves_alone_what_is_not_its_own_or_in_use(tmp_path: Path) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, ONCE, tmp_path)
    entry.folder.mkdir()
    (entry.folder / "parameters.json").write_text("{}")
    with pytest.raises(RunFolderError, match="is not of a race"):
        race([entry], Workers())
    assert (entry.folder / "parameters.json").read_text() == "{}"
    begun = RunFolder.create(tmp_path / "begun", entry.config)
    with begun.journal_of(entry.config), pytest.raises(RunFolderError, match="in use by another training"):
        run_entry(replace(entry, folder=begun.path))
    assert begun.config() == entry.config


def test_a_race_leaves_out_what_another_is_at_until_its_end(tmp_path: Path) -> None:
    entries = entries_of(("random", "cma-es"), range(1), TINY, ONCE, tmp_path)
    busy, *others = entries
    RunFolder.create(busy.folder, busy.config)
    (busy.folder / TIME_FILE).write_text("1000\n")
    curves: list[RaceCurve] = []
    second = threading.Thread(target=lambda: curves.extend(race(entries, Workers())))
    with locked(busy.folder / LOCK_FILE):
        second.start()
        deadline = time.monotonic() + 60.0
        while not all(map(is_evaluated, others)) and time.monotonic() < deadline:
            time.sleep(0.05)
        assert all(map(is_evaluated, others)) and not is_evaluated(busy) and not curves
    second.join(60.0)
    assert is_evaluated(busy) and [curve.algo for curve in curves] == ["random", "cma-es"]
    assert curves[0].seconds > 1000.0 > curves[1].seconds


HEAD = "episodes,score,seconds,evaluations\n"
DAMAGED = [
    *(("race.csv", content) for content in ("", HEAD + 50 * "5,0.5,1,1\n", f"{HEAD}5,x,1,1\n10,0.5,1,1\n")),
    *(("race_scores.csv", f"seed,score\n{row}\n") for row in ("0,x", "1,0.5")),
    ("recommendations.csv", "episodes\nx\n"),
]


@pytest.mark.parametrize(("name", "content"), DAMAGED)
@pytest.mark.usefixtures("met")
def test_damaged_tables_are_named(name: str, content: str, tmp_path: Path) -> None:
    (entry,) = entries_of(("random",), range(1), TINY, ONCE, tmp_path)
    race([entry], Workers())
    (entry.folder / name).write_text(content)
    if name == "recommendations.csv":
        entry = replace(entry, evaluations=Evaluations(2, 1))
    with pytest.raises(RunFolderError, match=r"random-s0.* cannot be read") as raised:
        race([entry], Workers())
    assert len(str(raised.value).splitlines()) == 1
