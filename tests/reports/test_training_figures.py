"""The paper's figures from run folders."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from laboratory import RESULT
from matplotlib.figure import Figure
from matplotlib.image import imread
from pytest import MonkeyPatch

from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import STEPPING, TASKS
from sarah.errors import RunFolderError
from sarah.pictures.colours import algorithm_colours
from sarah.reports import training_figures
from sarah.reports.race_entry import RaceCurve
from sarah.reports.training_figures import draw_race
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.runs.run_record import RunRecord

Drawn = dict[str, Figure]


def run_with_episodes(path: Path, task: str, count: int, algo: str = "naf", best: float = 1.0) -> RunFolder:
    run = RunFolder.create(path, TrainingConfig(task=task, algo=algo))
    spec = EpisodeSpec((0.5,) * len(TASKS[task].parameters), 0, task)
    for index in range(count):
        position = (0.01 * index, -0.01, 0.84)
        result = replace(RESULT, episode_return=best * index / count, final_position=position)
        run.append_episode(index, replace(spec, seed=index), result)
    return run


def draw_figures(runs: Sequence[RunFolder], folder: Path) -> list[Path]:
    return training_figures.draw_figures([RunRecord(run) for run in runs], folder)


@pytest.fixture
def drawn(monkeypatch: MonkeyPatch) -> Iterator[dict[str, Figure]]:
    figures: dict[str, Figure] = {}

    def keep(figure: Figure, path: Path) -> list[Path]:
        figures[path.name] = figure
        return []

    monkeypatch.setattr(training_figures, "save", keep)
    yield figures
    plt.close("all")


def words_of(figure: Figure) -> list[str]:
    (legend,) = figure.legends
    return sorted(text.get_text() for text in legend.get_texts())


def test_the_two_trainings_make_figures_4_to_7(tmp_path: Path) -> None:
    runs = [run_with_episodes(tmp_path / task, task, 10) for task in ("stepping", "balance")]
    files = draw_figures(runs, tmp_path / "out")
    assert sorted(file.name for file in files) == sorted(path.name for path in (tmp_path / "out").iterdir())
    of_stepping, of_balance = ("4_reward_and_frequency", "5_parameters"), ("6_reward_and_position", "7_parameters")
    names = [f"figure_{name}.{suffix}" for name in (*of_stepping, *of_balance) for suffix in ("pdf", "png")]
    assert sorted(file.name for file in files) == names
    for file in (file for file in files if file.suffix == ".png"):
        picture = imread(file)
        assert picture.shape[1] == 700 and picture[..., :3].std() > 0.02


def test_another_task_has_figures_if_it_has_episodes(tmp_path: Path, drawn: Drawn, monkeypatch: MonkeyPatch) -> None:
    task = replace(STEPPING, name="three", parameters=STEPPING.parameters[:3], baseline=(0.4, 1.3, 0.1))
    monkeypatch.setitem(TASKS, task.name, task)
    draw_figures([run_with_episodes(tmp_path / "run", task.name, 20)], tmp_path / "out")
    assert set(drawn) == {"three_reward_and_frequency", "three_parameters"}
    with pytest.raises(RunFolderError, match="has no episodes"):
        draw_figures([run_with_episodes(tmp_path / "empty", task.name, 0)], tmp_path / "none")
    assert not (tmp_path / "none").exists()


def test_runs_of_different_length_and_algorithm_share_a_figure(tmp_path: Path, drawn: Drawn) -> None:
    runs = [run_with_episodes(tmp_path / f"naf{i}", "stepping", 20 + i) for i in range(3)]
    draw_figures([*runs, run_with_episodes(tmp_path / "cma", "stepping", 20, "cma-es")], tmp_path / "out")
    words = ["CMA-ES", "NAF, 3 runs", "random warm-up of some"]
    assert words_of(drawn["figure_4_reward_and_frequency"]) == words


def test_several_runs_are_a_median_between_quartiles(tmp_path: Path, drawn: Drawn) -> None:
    runs = [run_with_episodes(tmp_path / f"{best}", "stepping", 20, best=best) for best in (0.0, 1.0, 2.0, 4.0, 8.0)]
    draw_figures(runs, tmp_path / "out")
    (axis, _) = drawn["figure_4_reward_and_frequency"].axes
    (band,), (*_, line) = axis.collections, axis.lines
    x, y = np.array(band.get_paths()[0].vertices).T
    last = y[x == x.max()]
    assert 2.0 * last.min() == last.max() / 2.0 == pytest.approx(np.ravel(line.get_ydata())[-1])


@pytest.mark.parametrize("count", [11, 60])
def test_the_line_of_a_training_rises_with_its_episodes_to_both_ends(count: int, tmp_path: Path, drawn: Drawn) -> None:
    draw_figures([run_with_episodes(tmp_path / "run", "stepping", count)], tmp_path / "out")
    (axis, _) = drawn["figure_4_reward_and_frequency"].axes
    (line,) = (line for line in axis.lines if line.get_linestyle() == "-")
    values = np.ravel(line.get_ydata())
    tried = np.arange(8, count) / count  # after the warm-up
    assert (np.diff(values) >= 0.0).all()
    assert values[[0, -1]] == pytest.approx([np.median(tried[:8]), np.median(tried[-8:])])


def test_axes_and_lines_have_their_names(tmp_path: Path, drawn: Drawn) -> None:
    run = run_with_episodes(tmp_path / "run", "stepping", 20, "td3")
    run.append_recommendation(5, dict.fromkeys(STEPPING.parameter_names, 0.3))
    draw_figures([run], tmp_path / "out")
    outcome, parameters = drawn["figure_4_reward_and_frequency"], drawn["figure_5_parameters"]
    assert [axis.get_ylabel() for axis in outcome.axes] == ["return (m³ s)", "steps per second"]
    assert words_of(outcome) == ["TD3", "random warm-up"]
    assert [axis.get_ylabel() for axis in parameters.axes] == [parameter.label for parameter in STEPPING.parameters]
    assert words_of(parameters) == ["TD3, tried", "paper", "random warm-up", "recommended"]


@pytest.mark.parametrize(("algo", "warm_up"), [("naf", 8), ("gp", 8), ("cma-es", 0)])
def test_the_warm_up_is_shaded_and_no_line_goes_through_it(
    algo: str, warm_up: int, tmp_path: Path, drawn: Drawn
) -> None:
    draw_figures([run_with_episodes(tmp_path / "run", "stepping", 40, algo)], tmp_path / "out")
    (axis, *_) = drawn["figure_4_reward_and_frequency"].axes
    to_data = axis.transData.inverted()
    shades = [tuple(patch.get_window_extent().transformed(to_data).intervalx) for patch in axis.patches]
    assert shades == ([pytest.approx((0.5, warm_up + 0.5))] if warm_up else [])
    lines = [line for line in axis.lines if line.get_linestyle() == "-"]
    assert [float(np.min(line.get_xdata())) for line in lines] == [warm_up + 1]


def test_algorithms_without_a_colour_of_their_own_are_told_apart(tmp_path: Path, drawn: Drawn) -> None:
    names = [*ALGORITHMS, "mine", "yours", "theirs"]
    colours = algorithm_colours(names)
    assert len(set(colours.values())) == len(names) and colours == algorithm_colours(reversed(names))
    assert algorithm_colours(["naf"])["naf"] == colours["naf"]
    draw_race([RaceCurve(algo, (5, 10), (0.2, 0.8), (0.8,), 1, 1.0) for algo in ("naf", "mine")], tmp_path / "race")
    (lines, _) = drawn["race"].axes
    assert [line.get_color() for line in lines.lines] == [algorithm_colours([name])[name] for name in ("naf", "mine")]
