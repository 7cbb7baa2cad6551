"""Tables of pushes, of grounds, and of engines: the same conditions for every controller, and honest intervals."""

import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import matplotlib.image
import numpy as np
import pytest
from laboratory import COARSE_PHYSICS, RESULT
from matplotlib.figure import Figure
from terminal import done

from sarah import EpisodeConfig, EpisodeResult, EpisodeSpec, Evaluation, Push, PushedConfig, Terrain, simulate
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.episode.workers import Workers
from sarah.reports import robustness, terrain, terrain_figure, transfer
from sarah.reports.robustness import PushedEpisode, push_many, robustness_table, wilson_interval
from sarah.reports.terrain import Situation, as_markdown, situations, try_terrain
from sarah.reports.transfer import Transfer
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.scale import Scale
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder

FALL = replace(RESULT, score=0.1, termination="left_box", final_position=(0.3, 0.0, 0.8))


def pushed(degrees: float, result: EpisodeResult = RESULT, newtons: float = 100.0) -> PushedEpisode:
    return PushedEpisode(newtons, math.radians(degrees), result)


def test_controllers_meet_the_same_pushes_and_can_be_repeated(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robustness, "SECONDS_AFTER", 0.1)
    still, moving = push_many(
        [(0.0,) * 4, (1.0, 0.0, 1.0, 0.0)],
        BalanceConfig(physics=COARSE_PHYSICS, push=Push(sagittal_share=1.0)),  # they come from everywhere all the same
        *(Workers(), (20.0, 40.0), 2),
    )
    assert [e.newtons for e in still] == [20.0, 20.0, 40.0, 40.0]
    assert [e.radians for e in still] == [e.radians for e in moving]
    assert still[0].radians == pytest.approx(still[2].radians) != still[1].radians
    assert [e.result for e in still] != [e.result for e in moving]
    assert {e.result.duration for e in still} == {3.25}
    push = Push(newtons=(40.0, 40.0), at_seconds=robustness.PUSHED_BETWEEN)
    config = BalanceConfig(physics=COARSE_PHYSICS, push=push, time_limit=3.25)
    assert simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), 1, "balance", config)) == moving[3].result


def test_table_counts_by_direction() -> None:
    for direction, degrees in (("lateral", (0, 40, -170, 179)), ("sagittal", (50, 90, -90, 130))):
        assert {pushed(angle).direction for angle in degrees} == {direction}
    found = robustness_table([pushed(0), pushed(180, FALL), pushed(90), pushed(90), pushed(0, newtons=25.0)])
    table = {group: (evaluation.episodes, evaluation.survival_rate) for group, evaluation in found.items()}
    hard = {(100.0, "all"): (4, 0.75), (100.0, "lateral"): (2, 0.5), (100.0, "sagittal"): (2, 1.0)}
    assert table == {(25.0, "all"): (1, 1.0), (25.0, "lateral"): (1, 1.0), **hard}
    everything = found[100.0, "all"]
    assert everything.median("score") == 0.8 and everything.median("drift") == pytest.approx(0.05)


def test_the_interval_is_wilsons() -> None:
    assert wilson_interval(81, 263) == pytest.approx((0.2553, 0.3662), abs=1e-4)  # as published


def test_eval_prints_the_table_and_leaves_it_with_a_plot(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    fallen = [pushed(degrees, FALL, newtons) for newtons in (50.0, 100.0) for degrees in range(0, 360, 45)]
    up = [replace(episode, result=RESULT) for episode in fallen]
    monkeypatch.setattr(robustness, "push_many", lambda *_, **__: [fallen, up])
    printed = done("sarah-eval", "1,0,1,0", "--robustness", "--out", "out", cwd=tmp_path).stdout
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"robustness.md", "robustness.png", "robustness.pdf"}
    assert (tmp_path / "out" / "robustness.md").read_text() in printed
    assert "score, drift, vibration: medians" in printed
    row = next(line for line in printed.splitlines() if line.startswith("| 100 N | all"))
    assert "| 8 | 0.00 (0.00 to 0.32)" in row and "1.00 (0.68 to 1.00)" in row


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
    small = EpisodeConfig(dimensions=dimensions_alike(0.5, 0.2))  # for which bumps lie closer
    ground = Situation("roughness", 0.005, "", 0.0).config(STEPPING, small).terrain
    assert ground == Terrain(roughness=0.005, cell=0.025, reach=0.35)


def test_every_situation_meets_the_same_seeds(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(terrain, "TIME_LIMIT", 1.1)
    tried = [Situation("slope", 0.0, "", 0.0), Situation("slope", 20.0, "right", 0.0)]
    found = try_terrain(STEPPING, (1.0, 1.0, 1.0, 1.0, 1.0), EpisodeConfig(), [3], Workers(), tried)
    level, steep = found.values()
    assert list(found) == tried and level.episodes == steep.episodes == 1 and level != steep


def test_table_has_score_steps_and_sensors_beside_survival() -> None:
    found = Evaluation((RESULT,) * 4)
    tried = [
        *(Situation("slope", 0.0, "", 0.0), Situation("slope", 4.0, "left", 75.0)),
        *(Situation("roughness", 0.015, "", 0.0), Situation("friction", 0.25, "", 0.0)),
    ]
    lines = as_markdown(dict.fromkeys(tried, found)).splitlines()
    grounds = ["| level", "| 4° uphill left", "| bumps of 15 mm", "| friction 0.25"]
    assert [line.split(" | ")[0] for line in lines[2:]] == grounds
    cells = f"{RESULT.score:.3f} | {RESULT.steps_per_second:.2f} | {RESULT.shifts_by_sensors:.0%}"
    assert all(cells in line for line in lines[2:]) and "| 75 N |" in lines[3]


def test_command_writes_table_and_picture(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def found(*arguments: Any) -> dict[Situation, Evaluation]:  # its last but one argument are the situations
        return dict.fromkeys(arguments[-2], Evaluation((RESULT,) * 3))

    monkeypatch.setattr(terrain, "try_terrain", found)
    config = TrainingConfig(episode=EpisodeConfig(terrain=Terrain(roughness=(0.0, 0.01))))
    run = RunFolder.create(tmp_path / "run", config)  # trained on ground of its own
    run.write_parameters({"parameters": dict(zip(STEPPING.parameter_names, STEPPING.baseline, strict=True))})
    options = "run --terrain --out out --episodes 3 --episode.payload 20"
    printed = done("sarah-eval", *options.split(), cwd=tmp_path).stdout
    assert {path.name for path in (tmp_path / "out").iterdir()} == {"terrain.md", "terrain.png", "terrain.pdf"}
    table = (tmp_path / "out" / "terrain.md").read_text()
    assert "- SHIFT by sensors: mean share of the SHIFT phases that sensors ended\n" in table
    assert table in printed and "--episode.payload 20" in table and "payload 20 instead of 0" in table
    assert matplotlib.image.imread(tmp_path / "out" / "terrain.png").std() > 0.05


def test_the_picture_shows_every_row(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    drawn: list[Figure] = []
    monkeypatch.setattr(terrain_figure, "save", lambda figure, path: drawn.append(figure))
    slow, fast = (replace(RESULT, steps_per_second=steps) for steps in (2.0, 4.0))
    evaluations = {one: Evaluation((fast if one.kind == "friction" else slow,) * 3) for one in situations(Scale())}
    terrain_figure.draw_terrain(evaluations, tmp_path / "terrain")
    for axis in drawn[0].axes:
        low, high = axis.get_ylim()
        values = np.concatenate([np.ravel(line.get_ydata()) for line in axis.get_lines()])
        assert low <= values.min() and values.max() < high


def scoring(score: float) -> Evaluation:
    return Evaluation((replace(RESULT, score=score),))


LEARNED = EpisodeSpec(PAPER_STEPPING, 0, STEPPING, EpisodeConfig(engine="mujoco"))
SCORES: dict[Any, Evaluation] = {"pybullet": scoring(0.6), "mujoco": scoring(0.8)}


def test_the_name_of_a_run_stays_in_its_cell_of_the_table() -> None:
    rows = [transfer.as_markdown([Transfer(name, LEARNED, SCORES)]) for name in ("run_1", "a|b", "[x](y) `<b>`")]
    assert "| run_1 |" in rows[0] and r"| a\|b |" in rows[1] and r"| \[x\](y) \`\<b\>\` |" in rows[2]


def test_kept_is_the_lowest_share_in_any_other_engine() -> None:
    scores = {**SCORES, "third": scoring(0.4)}
    assert Transfer("run", LEARNED, scores).kept == pytest.approx(0.5)
    assert Transfer("run", LEARNED, {**scores, "mujoco": scoring(0.0)}).kept == 0.0
