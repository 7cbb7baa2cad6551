"""A run as one page, and what TensorBoard shows of it."""

import base64
import json
import re
import shutil
from collections import Counter
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from laboratory import NEEDS_PYBULLET, RESULT
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from tensorboard.plugins.hparams.plugin_data_pb2 import HParamsPluginData
from terminal import done

from sarah import EpisodeConfig, EpisodeSpec, Physics
from sarah.episode.episode import Episode
from sarah.episode.evaluation import Evaluation
from sarah.episode.tasks import STEPPING, TASKS
from sarah.errors import ConfigurationError
from sarah.reports import all_figures, report, training_figures
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.engines import is_installed
from sarah.training import train as training
from sarah.training.train import train

PHYSICS = Physics(rate=100, solver_iterations=10, control_rate=100)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> RunFolder:
    episode = EpisodeConfig(time_limit=1.5, physics=PHYSICS)
    pictures = 5 if is_installed("pybullet") else 0
    config = TrainingConfig(episodes=10, seed=3, slots=1, episode=episode, pictures=pictures)
    made = RunFolder.create(tmp_path_factory.mktemp("runs") / "run", config)
    with pytest.MonkeyPatch.context() as monkeypatch:
        monkeypatch.setattr(training, "SUMMARY_EPISODES", 2)
        train(config, made)
    return made


@NEEDS_PYBULLET
def test_report_is_a_page_that_needs_nothing_else(run: RunFolder, tmp_path: Path) -> None:
    line = f"sarah-report {run.path} --out page.html --episodes 2 --seconds 1 1.2"
    ended = done(*line.split(), cwd=tmp_path)
    assert f"{run.path}\n" in ended.stderr and "--task" not in ended.stderr
    assert ended.stdout == "page.html\n" and [path.name for path in tmp_path.iterdir()] == ["page.html"]
    text = (tmp_path / "page.html").read_text(encoding="utf-8")
    addresses = re.findall(r'(?:src|href)="([^"]{0,40})', text)
    assert addresses and all(address.startswith("data:") for address in addresses) and "url(" not in text
    pictures = re.findall(r'data:image/png;base64,([^"]+)', text)
    assert len(pictures) == 4  # both of the training, state machine, robot; in half a second there is no gait cycle
    assert all(base64.b64decode(picture).startswith(b"\x89PNG") for picture in pictures)
    (film,) = re.findall(r'data:(?:video/mp4|image/gif);base64,([^"]+)', text)
    assert len(base64.b64decode(film)) > 1000
    (settings,) = re.findall(r'data:text/yaml;base64,([^"]+)', text)
    assert base64.b64decode(settings).decode() == run.config_text()
    for name, value in zip(STEPPING.parameter_names, run.parameters(), strict=True):
        assert re.search(rf"<td>{name}[^<]*</td><td>{value:.2f}</td>", text)
    noted = json.loads((run.path / "parameters.json").read_text())["evaluation"]  # of the same seeds
    assert f"<td>{noted['score_mean']:.3f}</td>" in text and f"<td>{noted['vibration_median']:.1f} m²/s⁴</td>" in text
    assert "about 0.4" in text  # the paper's P1
    assert re.search(r"from 1\.0 to 1\.2 s of [\d.]+ s: .*time_limit 1\.5\.</figcaption>", text)  # what is not as usual


@pytest.fixture
def counts(monkeypatch: pytest.MonkeyPatch) -> Counter[Any]:
    """Counts of what is read of run folders, and of the episodes that are simulated, by parameters and seed."""
    counted: Counter[Any] = Counter()

    def count(owner: type, name: str, key: Callable[..., Any]) -> None:
        original = getattr(owner, name)
        monkeypatch.setattr(owner, name, lambda *given: (counted.update([key(*given)]), original(*given))[1])

    count(Episode, "of", lambda spec, *_: (spec.parameters, spec.seed))
    for name in ("config", "config_text", "parameters", "episodes", "recommendations"):
        count(RunFolder, name, lambda *_, name=name: name)
    for module in (training_figures, all_figures, report):  # drawing would take most of the time
        for name in {"save", "draw_robot", "draw_state_machine", "frames"} & set(vars(module)):
            monkeypatch.setattr(module, name, lambda *_, **__: [Path("drawn.png")])
    monkeypatch.setattr(report, "write_video", lambda _, path: path.touch())
    return counted


@pytest.mark.parametrize("task", TASKS)
def test_a_run_is_read_once_and_no_episode_is_simulated_twice(task: str, counts: Counter[Any], tmp_path: Path) -> None:
    episode = replace(TASKS[task].episode, time_limit=1.2, physics=PHYSICS)
    config = TrainingConfig(task, episodes=1, episode=episode)
    run, learned = RunFolder.create(tmp_path / "run", config), (0.5,) * len(TASKS[task].parameters)
    run.append_episode(0, EpisodeSpec(learned, 2**31, task, episode), RESULT)
    run.write_parameters({"parameters": dict(zip(TASKS[task].parameter_names, learned, strict=True))})
    for line in ("sarah-report run --out page.html --episodes 2", "sarah-figures run --out out"):
        counts.clear()
        done(*line.split(), cwd=tmp_path)
        assert counts[learned, 0] == counts["episodes"] == counts["config"] == 1
        assert set(counts.values()) == {1}, counts
    assert ("about 0.4" in (tmp_path / "page.html").read_text()) == (task == "stepping")


@pytest.mark.parametrize("task", TASKS)
@pytest.mark.parametrize(("noted", "is_known"), [({}, True), ({"score_mean": None}, False), ({"episodes": 3}, False)])
def test_what_a_training_has_evaluated_is_not_simulated_again(
    task: str, noted: dict[str, Any], is_known: bool, counts: Counter[Any], tmp_path: Path
) -> None:
    config = TrainingConfig(task, episodes=1, episode=replace(TASKS[task].episode, time_limit=1.2, physics=PHYSICS))
    run, learned = RunFolder.create(tmp_path / "run", config), (0.5,) * len(TASKS[task].parameters)
    run.append_episode(0, EpisodeSpec(learned, 2**31, task, config.episode), RESULT)
    summary = {**Evaluation((RESULT,) * 2).summary(), "score_mean": 0.987, **noted}
    named = dict(zip(TASKS[task].parameter_names, learned, strict=True))
    run.write_parameters({"parameters": named, "evaluation": summary, "baseline": TASKS[task].neutral and summary})
    done("sarah-report", "run", "--out", "page.html", "--episodes", "2", cwd=tmp_path)
    assert ("<td>0.987</td>" in (tmp_path / "page.html").read_text()) == is_known
    simulated = {key for key in counts if isinstance(key, tuple)}
    of_baseline = {(TASKS[task].baseline, 0), (TASKS[task].baseline, 1)}
    known = of_baseline if TASKS[task].neutral else set()
    assert simulated == {(learned, 0), (learned, 1), *of_baseline} - ({(learned, 1), *known} if is_known else set())


@pytest.mark.usefixtures("counts")
def test_what_a_report_cannot_show_is_said(run: RunFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse() -> None:
        raise ConfigurationError("pictures need a package")

    monkeypatch.setattr(report, "check_renderer", refuse)
    monkeypatch.setattr(report, "physics_warning", lambda *_: "scores err")
    folder = shutil.copytree(run.path, tmp_path / "<i>run")  # a name that is no HTML
    done("sarah-report", str(folder), "--out", "page.html", "--episodes", "1", cwd=tmp_path)
    page = (tmp_path / "page.html").read_text()
    assert "No video: pictures need a package." in page and "<video" not in page
    assert '<p class="warning">Scores err.</p>' in page
    assert "&lt;i&gt;run" in page and "<i>" not in page


def events(run: RunFolder) -> EventAccumulator:
    (path,) = run.path.glob("events.out.tfevents.*")
    accumulator = EventAccumulator(str(path), size_guidance={"images": 0, "scalars": 0})
    accumulator.Reload()
    return accumulator


@NEEDS_PYBULLET
def test_tensorboard_shows_curves_in_groups_and_pictures(run: RunFolder) -> None:
    shown = events(run)
    groups = {tag.split("/")[0] for tag in shown.Tags()["scalars"]}
    assert groups == {"episode", "parameters", "recommendation", "robot", "train", "unseen"}
    rows = [(int(row["episodes"]), float(row["P1"])) for row in run.recommendations()]
    assert [(event.step, pytest.approx(event.value)) for event in shown.Scalars("recommendation/P1")] == rows
    films = shown.Images("recommendation/video")
    assert [film.step for film in films] == [episodes for episodes, _ in rows]
    assert all(film.encoded_image_string.startswith(b"GIF89a") and film.width == 640 for film in films)
    content = shown.SummaryMetadata("_hparams_/session_start_info").plugin_data.content
    known = HParamsPluginData.FromString(content).session_start_info.hparams
    assert known["task"].string_value == "stepping" and known["seed"].number_value == 3


@NEEDS_PYBULLET
def test_pictures_change_nothing_of_a_training(run: RunFolder, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(training, "SUMMARY_EPISODES", 2)
    config = replace(run.config(), pictures=0)
    without = RunFolder.create(tmp_path / "without", config)
    train(config, without)
    for name in ("episodes.csv", "recommendations.csv", "progress.csv", "parameters.json"):
        assert (without.path / name).read_bytes() == (run.path / name).read_bytes()
    assert not events(without).Tags()["images"]
