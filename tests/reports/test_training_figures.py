"""The paper's figures from run folders."""

from pathlib import Path

import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET
from matplotlib.image import imread

from sarah.control import hip_law as hips
from sarah.control import pattern_generator
from sarah.control.pattern_generator import Phase, SteppingParameters
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import TASKS
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.errors import ConfigurationError, RunFolderError
from sarah.pictures.gait_figure import draw_gait_cycle, gait_cycle
from sarah.pictures.robot_figure import draw_robot, labels_of
from sarah.pictures.state_machine_figure import draw_state_machine, read_hip_law, read_state_machine
from sarah.reports.race import Curve
from sarah.reports.training_figures import draw_figures, draw_race, running_median
from sarah.robot.description import RobotDescription, describe_robot
from sarah.runs.config import ALGORITHMS, TrainingConfig
from sarah.runs.run_folder import RunFolder


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
    with pytest.raises(RunFolderError, match="has no episodes"):
        draw_figures([run], tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_running_median_ignores_single_outliers() -> None:
    values = np.zeros(40)
    values[20] = 100.0
    assert (running_median(values) == 0.0).all()


def test_state_machine_is_read_from_the_code_that_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    shift, lift, land = read_state_machine()
    assert [facts.phase for facts in (shift, lift, land)] == [Phase.SHIFT, Phase.LIFT, Phase.LAND]
    assert [facts.following for facts in (shift, lift, land)] == [Phase.LIFT, Phase.LAND, Phase.SHIFT]
    assert [facts.swaps_legs for facts in (shift, lift, land)] == [False, False, True]
    assert shift.conditions[:2] == ("tilt > P2", f"rate > {pattern_generator.RATE_SCALE:g} P3")
    assert (shift.swing_length, lift.swing_length) == (-pattern_generator.PUSH_LENGTH, pattern_generator.LIFT_LENGTH)
    assert lift.time_out == f"{pattern_generator.TIME_OUT_SECONDS:g} (1 + P4)"
    monkeypatch.setattr(pattern_generator, "RATE_SCALE", 0.7)
    monkeypatch.setattr(pattern_generator, "LIFT_LENGTH", 0.011)
    monkeypatch.setattr(pattern_generator, "TIME_OUT_SECONDS", 0.2)
    shift, lift, _ = read_state_machine()
    assert "rate > 0.7 P3" in shift.conditions and lift.swing_length == 0.011 and lift.time_out == "0.2 (1 + P4)"


def test_hip_law_is_read_from_the_code_that_runs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(hips, "PITCH_SCALE", 9.5)
    assert read_hip_law()["flexion of the swing leg"] == f"9.5 V3 pitch + {hips.FLEXION_SCALE:g} V4"


@NEEDS_PYBULLET
def test_robot_and_state_machine_are_drawn(tmp_path: Path) -> None:
    files = draw_robot(describe_robot(), tmp_path / "robot") + draw_state_machine(tmp_path / "machine")
    assert {file.name for file in files} == {"robot.png", "robot.pdf", "machine.png", "machine.pdf"}
    for file in files[::2]:
        picture = imread(file)
        assert picture.shape[1] == 700 and picture[..., :3].std() > 0.02


def test_labels_point_at_the_robot_as_it_is() -> None:
    def knee(robot: RobotDescription) -> tuple[str, float]:
        (label,) = (label for label in labels_of(robot) if label.text.startswith("leg length"))
        return label.text, label.point[2]

    (text, height), (other_text, other_height) = (
        knee(describe_robot(dimensions)) for dimensions in ({}, {"thigh_length": 0.5, "leg_retract_limit": 0.2})
    )
    assert "+120 mm" in text and "+200 mm" in other_text
    assert abs(height - other_height) < 0.06  # the knee stands as high, the hips higher


def test_gait_cycle_is_one_step_with_each_leg(tmp_path: Path) -> None:
    config = EpisodeConfig(time_limit=6.0)
    trace = simulate(EpisodeSpec(TRAINED_STEPPING, 0, config=config), record_trace=True).trace
    assert trace is not None
    rows = gait_cycle(trace)
    assert 0.3 < trace.time[rows][-1] - trace.time[rows][0] < 1.2
    support = trace.stance[rows]
    assert (np.diff(support) != 0).sum() == 2 and support[0] == support[-1] == 1
    files = draw_gait_cycle(trace, SteppingParameters(*TRAINED_STEPPING), tmp_path / "cycle")
    assert [file.name for file in files] == ["cycle.png", "cycle.pdf"]


def test_robot_that_makes_no_cycle_has_none_to_draw() -> None:
    spec = EpisodeSpec(TRAINED_STEPPING, 0, config=EpisodeConfig(time_limit=1.3))
    trace = simulate(spec, record_trace=True).trace
    assert trace is not None
    with pytest.raises(ConfigurationError, match="completes no cycle"):
        gait_cycle(trace)


def test_a_race_of_all_algorithms_has_room_for_its_legend(tmp_path: Path) -> None:
    """Nothing is drawn on the picture's border, where it would be cut off."""
    curves = [Curve(algo, (5, 10), (0.2, 0.8), 1.0) for algo in ALGORITHMS for _ in range(10)]
    picture, _ = draw_race(curves, tmp_path / "race")
    pixels = imread(picture)[..., :3]
    for border in (pixels[0], pixels[-1], pixels[:, 0], pixels[:, -1]):
        assert (border == 1.0).all()
