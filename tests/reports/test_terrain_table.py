"""The table of grounds, and its command."""

import dataclasses
import sys
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from laboratory import RESULT
from matplotlib.figure import Figure

from sarah.episode.evaluation import Evaluation
from sarah.episode.push import Push, PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import BALANCE, STEPPING
from sarah.episode.workers import Workers
from sarah.reports import robustness, terrain, terrain_figure
from sarah.reports.terrain import Situation, as_markdown, situations, try_terrain
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.scale import Scale
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.simulation.terrain import Terrain


def test_situations_are_grounds_each_without_a_push_and_with_one() -> None:
    found = list(situations(Scale()))
    assert len(found) == 2 * (1 + 4 * 4 + 4 + 5) == len(set(found))
    without, pushed = (({one.terrain for one in found if one.newtons == newtons}) for newtons in (0.0, 75.0))
    assert without == pushed
    assert Terrain() in without
    assert Terrain(slope_degrees=(8.0, 8.0), direction_degrees=(180.0, 180.0)) in without
    assert Terrain(roughness=(0.01, 0.01)) in without
    assert Terrain(friction_left=(0.25, 0.25), friction_right=(0.25, 0.25)) in without


@pytest.mark.parametrize("task", [STEPPING, BALANCE])
def test_a_situation_changes_ground_push_and_time_limit_only(task: Any) -> None:
    own = task.config_of(task.episode, controller=task.episode.controller)
    pushed = Situation("roughness", 0.01, "", 75.0).config(task, own)
    assert isinstance(pushed, PushedConfig)
    assert pushed.push == Push((75.0, 75.0), at_seconds=robustness.PUSHED_BETWEEN)
    assert pushed.terrain == Terrain(roughness=(0.01, 0.01)) and pushed.time_limit == terrain.TIME_LIMIT
    free = Situation("friction", 0.25, "", 0.0).config(task, own)
    assert not isinstance(free, PushedConfig) or free.push.newtons == (0.0, 0.0)
    assert (free.engine, free.randomisation) == (own.engine, own.randomisation)


def test_bumps_of_the_table_lie_closer_for_a_small_robot() -> None:
    small = EpisodeConfig(dimensions=dimensions_alike(0.5, 0.2))
    ground = Situation("roughness", 0.005, "", 0.0).config(STEPPING, small).terrain
    assert ground == Terrain(roughness=0.005, cell=0.025, reach=0.35)


def test_every_situation_meets_the_same_seeds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(terrain, "TIME_LIMIT", 1.1)
    tried = [Situation("slope", 0.0, "", 0.0), Situation("slope", 20.0, "right", 0.0)]
    found = try_terrain(STEPPING, (1.0, 1.0, 1.0, 1.0, 1.0), EpisodeConfig(), [3], Workers(), tried)
    assert list(found) == tried
    level, steep = found.values()
    assert level.episodes == steep.episodes == 1
    assert level != steep


def test_table_has_score_steps_and_sensors_beside_survival() -> None:
    found = Evaluation((RESULT,) * 4)
    tried = [
        Situation("slope", 0.0, "", 0.0),
        Situation("slope", 4.0, "left", 75.0),
        Situation("roughness", 0.015, "", 0.0),
        Situation("friction", 0.25, "", 0.0),
    ]
    lines = as_markdown(dict.fromkeys(tried, found)).splitlines()
    assert [line.split(" | ")[0] for line in lines[2:]] == [
        "| level",
        "| 4° uphill left",
        "| bumps of 15 mm",
        "| friction 0.25",
    ]
    cells = f"{RESULT.score:.3f} | {RESULT.steps_per_second:.2f} | {RESULT.shifts_by_sensors:.0%}"
    assert all(cells in line for line in lines[2:]) and "| 75 N |" in lines[3]


def test_command_writes_table_and_picture(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    from sarah.cli.eval import main

    def found(*arguments: Any) -> dict[Situation, Evaluation]:  # its last but one argument are the situations
        return dict.fromkeys(arguments[-2], Evaluation((RESULT,) * 3))

    monkeypatch.setattr(terrain, "try_terrain", found)
    config = TrainingConfig(episode=EpisodeConfig(terrain=Terrain(roughness=(0.0, 0.01))))
    run = RunFolder.create(tmp_path / "run", config)  # trained on ground of its own
    run.write_parameters({"parameters": dict(zip(STEPPING.parameter_names, STEPPING.baseline, strict=True))})
    arguments = f"{run.path} --terrain --out {tmp_path / 'out'} --episodes 3 --episode.payload 20".split()
    monkeypatch.setattr(sys, "argv", ["sarah-eval", *arguments])
    main()
    printed = capsys.readouterr().out
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"terrain.md", "terrain.png", "terrain.pdf"}
    table = (tmp_path / "out" / "terrain.md").read_text()
    assert "- SHIFT by sensors: mean share of the SHIFT phases that sensors ended\n" in table
    assert table in printed and "--episode.payload 20" in table and "payload 20 instead of 0" in table
    assert matplotlib.image.imread(tmp_path / "out" / "terrain.png").std() > 0.05


def test_the_picture_shows_every_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(terrain_figure, "save", lambda figure, path: drawn.append(figure))
    slow, fast = (dataclasses.replace(RESULT, steps_per_second=steps) for steps in (2.0, 4.0))
    evaluations = {
        situation: Evaluation((fast if situation.kind == "friction" else slow,) * 3)
        for situation in situations(Scale())
    }
    terrain_figure.draw_terrain(evaluations, tmp_path / "terrain")
    for axis in drawn[0].axes:
        low, high = axis.get_ylim()
        values = np.concatenate([np.ravel(line.get_ydata()) for line in axis.get_lines()])
        assert low <= values.min() and values.max() < high
