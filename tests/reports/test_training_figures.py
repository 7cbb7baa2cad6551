"""The paper's figures from run folders."""

import dataclasses
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from laboratory import RESULT
from matplotlib.figure import Figure
from matplotlib.image import imread

from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import STEPPING, TASKS
from sarah.errors import RunFolderError
from sarah.pictures.colours import algorithm_colours
from sarah.reports import training_figures
from sarah.reports.race_entry import RaceCurve
from sarah.reports.training_curves import read_curves
from sarah.reports.training_figures import draw_race
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.runs.run_record import RunRecord


def run_with_episodes(path: Path, task: str, count: int, algo: str = "naf", shift: float = 0.0) -> RunFolder:
    run = RunFolder.create(path, TrainingConfig(task=task, algo=algo))
    spec = EpisodeSpec((0.5,) * len(TASKS[task].parameters), 0, task)
    for index in range(count):
        position = (0.01 * index, -0.01, 0.84)
        result = dataclasses.replace(RESULT, episode_return=shift + index / count, final_position=position)
        run.append_episode(index, dataclasses.replace(spec, seed=index), result)
    return run


def draw_figures(runs: Sequence[RunFolder], folder: Path) -> list[Path]:
    return training_figures.draw_figures([RunRecord(run) for run in runs], folder)


def test_first_training_makes_figures_4_and_5_and_the_second_6_and_7(tmp_path: Path) -> None:
    runs = [run_with_episodes(tmp_path / task, task, 30) for task in ("stepping", "balance")]
    files = draw_figures(runs, tmp_path / "out")
    assert sorted(file.name for file in files) == sorted(path.name for path in (tmp_path / "out").iterdir())
    assert {file.stem for file in files} == {
        "figure_4_reward_and_frequency",
        "figure_5_parameters",
        "figure_6_reward_and_position",
        "figure_7_parameters",
    }
    assert {file.suffix for file in files} == {".png", ".pdf"}
    for file in files:
        if file.suffix == ".png":
            picture = imread(file)
            assert picture.shape[1] == 700 and picture[..., :3].std() > 0.02


def test_another_task_has_figures_of_its_own_parameters(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    task = dataclasses.replace(STEPPING, name="three", parameters=STEPPING.parameters[:3], baseline=(0.4, 1.3, 0.1))
    monkeypatch.setitem(TASKS, task.name, task)
    files = draw_figures([run_with_episodes(tmp_path / "run", task.name, 20)], tmp_path / "out")
    assert {file.stem for file in files} == {"three_reward_and_frequency", "three_parameters"}


def test_runs_of_different_length_and_algorithm_share_a_figure(tmp_path: Path) -> None:
    runs = [run_with_episodes(tmp_path / f"naf{i}", "stepping", 20 + i, shift=i) for i in range(3)]
    alone = draw_figures(runs, tmp_path / "alone")
    together = draw_figures([*runs, run_with_episodes(tmp_path / "td3", "stepping", 20, "td3")], tmp_path / "together")
    assert [file.name for file in alone] == [file.name for file in together]
    assert (imread(alone[0]) != imread(together[0])).any()


def test_run_without_episodes_is_named(tmp_path: Path) -> None:
    run = run_with_episodes(tmp_path / "run", "stepping", 0)
    with pytest.raises(RunFolderError, match="has no episodes"):
        draw_figures([run], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_axes_and_lines_have_their_names(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = run_with_episodes(tmp_path / "run", "stepping", 20, "td3")
    run.append_recommendation(5, dict.fromkeys(STEPPING.parameter_names, 0.3))
    drawn: dict[str, list[str]] = {}

    def look(figure: Figure, path: Path) -> list[Path]:
        (legend,) = figure.legends
        names = [axis.get_ylabel() for axis in figure.axes]
        drawn[path.name] = [*names, *sorted(text.get_text() for text in legend.get_texts())]
        return []

    monkeypatch.setattr(training_figures, "save", look)
    draw_figures([run], tmp_path / "out")
    assert drawn["figure_4_reward_and_frequency"] == ["return (m³ s)", "steps per second", "TD3", "random warm-up"]
    labels = [parameter.label for parameter in STEPPING.parameters]
    words = ["TD3, tried", "paper", "random warm-up", "recommended"]
    assert drawn["figure_5_parameters"] == [*labels, *words]


def colour_share(picture: Path, colour: str) -> float:
    wanted = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return float((np.abs(imread(picture)[..., :3] - wanted).max(axis=-1) < 0.02).mean())


@pytest.mark.parametrize(("algo", "shaded"), [("naf", True), ("td3", True), ("gp", True), ("cma-es", False)])
def test_the_random_warm_up_is_shaded(algo: str, shaded: bool, tmp_path: Path) -> None:
    for file in draw_figures([run_with_episodes(tmp_path / "run", "stepping", 40, algo)], tmp_path / "out"):
        if file.suffix == ".png":
            assert (colour_share(file, "#E0E0E0") > 0.05) == shaded


def test_no_line_goes_through_the_warm_up(tmp_path: Path) -> None:
    """What the eight random episodes gave changes dots, and not the line of what was learned."""
    pictures = []
    for shift in (0.0, 0.9):
        run = run_with_episodes(tmp_path / f"run{shift}", "stepping", 0)
        for index in range(40):
            result = dataclasses.replace(RESULT, episode_return=shift * (index % 3) / 2 if index < 8 else index / 40)
            run.append_episode(index, EpisodeSpec((0.5,) * 5, index), result)
        (curves,) = read_curves([RunRecord(run)], STEPPING)
        assert (curves.warm_up, curves.learning) == (8, 40)
        pictures.append(imread(draw_figures([run], tmp_path / f"out{shift}")[0]))
    line = [(np.abs(picture[..., :3] - (0.0, 114 / 255, 178 / 255)).max(axis=-1) < 0.05) for picture in pictures]
    assert line[0].sum() > 100 and (line[0] == line[1]).mean() > 0.999


def test_parameters_show_what_was_recommended_beside_what_was_tried(tmp_path: Path) -> None:
    run = run_with_episodes(tmp_path / "run", "stepping", 30)
    before = draw_figures([run], tmp_path / "before")
    for episodes in range(5, 31, 5):
        run.append_recommendation(episodes, dict.fromkeys(STEPPING.parameter_names, 0.3))
    after = draw_figures([run], tmp_path / "after")
    outcome, parameters = (
        (imread(one) != imread(other)).any() if imread(one).shape == imread(other).shape else True
        for one, other in zip(before[::2], after[::2], strict=True)
    )
    assert parameters and not outcome


def test_algorithms_without_a_colour_of_their_own_are_told_apart(tmp_path: Path) -> None:
    names = [*ALGORITHMS, "mine", "yours", "theirs"]
    colours = algorithm_colours(names)
    assert len(set(colours.values())) == len(names) and colours == algorithm_colours(reversed(names))
    assert algorithm_colours(["naf"])["naf"] == colours["naf"]
    curves = [RaceCurve(algo, (5, 10), (0.2, 0.8), (0.8,), 1, 1.0) for algo in ("naf", "mine")]
    picture, _ = draw_race(curves, tmp_path / "race")
    assert colour_share(picture, algorithm_colours(["mine"])["mine"]) > 0.0005


def test_a_figure_of_all_algorithms_has_room_for_its_legend(tmp_path: Path) -> None:
    runs = [run_with_episodes(tmp_path / f"{algo}{i}", "stepping", 20, algo) for algo in ALGORITHMS for i in range(2)]
    for file in draw_figures(runs, tmp_path / "out")[::2]:
        pixels = imread(file)[..., :3]
        for border in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):
            assert (border == 1.0).all()


def test_a_race_of_all_algorithms_has_room_for_its_legend(tmp_path: Path) -> None:
    """Nothing is drawn on the picture's border, where it would be cut off."""
    curves = [RaceCurve(algo, (5, 10), (0.2, 0.8), (0.7, 0.9), 2, 1.0) for algo in ALGORITHMS for _ in range(10)]
    picture, _ = draw_race(curves, tmp_path / "race")
    pixels = imread(picture)[..., :3]
    for border in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):
        assert (border == 1.0).all()
