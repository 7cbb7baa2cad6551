"""The paper's figures from run folders."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread

from sarah.config import TrainingConfig
from sarah.errors import RunFolderError
from sarah.figures import draw_figures, running_median
from sarah.runs import RunFolder
from sarah.tasks import TASKS


def run_with_episodes(path: Path, task: str, count: int, algo: str = "naf", shift: float = 0.0) -> RunFolder:
    run = RunFolder.create(path, TrainingConfig(task=task, algo=algo))
    names = TASKS[task].parameter_names
    for index in range(count):
        info = dict.fromkeys(("score", "steps_per_second", "duration"), 1.0) | {
            "seed": index,
            "episode_return": shift + index / count,
            "final_position": (0.01 * index, -0.01, 0.84),
            "parameters": (0.5,) * len(names),
        }
        run.append_episode(index, names, info)
    return run


def test_first_training_makes_figures_4_and_5_and_the_second_6_and_7(tmp_path: Path) -> None:
    runs = [run_with_episodes(tmp_path / task, task, 30) for task in TASKS]
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


def test_runs_of_different_length_and_algorithm_share_a_figure(tmp_path: Path) -> None:
    runs = [run_with_episodes(tmp_path / f"naf{i}", "stepping", 20 + i, shift=i) for i in range(3)]
    alone = draw_figures(runs, tmp_path / "alone")
    together = draw_figures([*runs, run_with_episodes(tmp_path / "td3", "stepping", 20, "td3")], tmp_path / "together")
    assert [file.name for file in alone] == [file.name for file in together]
    assert (imread(alone[0]) != imread(together[0])).any()


def test_run_without_simulations_is_named(tmp_path: Path) -> None:
    run = run_with_episodes(tmp_path / "run", "stepping", 0)
    with pytest.raises(RunFolderError, match="has no simulations"):
        draw_figures([run], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_running_median_ignores_single_outliers() -> None:
    values = np.zeros(40)
    values[20] = 100.0
    assert (running_median(values) == 0.0).all()
