"""No command drops a setting of what it looks at: what is simulated is the subject's own, and what is not is said."""

import contextlib
import dataclasses
import shlex
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from laboratory import RESULT
from pytest import MonkeyPatch
from terminal import run

from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.episode.push import PushedConfig
from sarah.episode.running_robot import RunningRobot
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING
from sarah.operation.settings import Change, OperationConfig
from sarah.operation.window import FELT, Window
from sarah.pictures import dimension_figure, session_figure
from sarah.reports import all_figures, robustness, terrain, terrain_figure, training_figures, transfer_figure
from sarah.robot.description import describe_robot
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import settings_by_key
from sarah.runs.run_episodes import RunEpisode
from sarah.runs.run_folder import RunFolder
from sarah.runs.session import SessionSpec
from sarah.runs.session_folder import SessionFolder
from sarah.simulation.engines import default_engine, is_installed
from sarah.simulation.physics import Physics

LEGS, HIPS = (0.45, 1.25, 0.15, 1.05, 0.95), (0.5, 0.1, 0.2, 0.3)
ENGINE = next((name for name in ("mujoco", "pybullet") if name != default_engine() and is_installed(name)), None)
CHOSEN: dict[str, Any] = {
    "engine": ENGINE or default_engine(),
    "physics": Physics(rate=500, solver_iterations=10, control_rate=125),
    "dimensions": {"thigh_length": 0.36},
    "time_limit": 1.3,
    "reward_form": "printed",
    "roughness": (0.0, 0.0),  # an operation refuses bumps
    "friction_left": (0.5, 0.6),
    "friction_right": (0.7, 0.8),
    "at_seconds": (1.05, 1.1),
    "stepping": LEGS,
}
"""Values of settings that a factor would not make."""


def odd(config: Any) -> Any:
    """The same settings, each with another value."""
    changes: dict[str, Any] = {}
    for name in (item.name for item in dataclasses.fields(config)):
        changes[name] = CHOSEN[name] if name in CHOSEN else _other(getattr(config, name))
    return dataclasses.replace(config, **changes)


def _other(value: Any) -> Any:
    if isinstance(value, bool):
        return not value
    if isinstance(value, float):
        return 0.98 * value or 0.01
    return tuple(map(_other, value)) if isinstance(value, tuple) else odd(value)


def trained(path: Path, config: TrainingConfig, learned: tuple[float, ...]) -> None:
    run = RunFolder.create(path, config)
    run.append_episode(0, EpisodeSpec(learned, 2**31, config.task, config.episode), RESULT)
    run.write_parameters({"parameters": dict(zip(config.task.parameter_names, learned, strict=True))})


@pytest.fixture(scope="module")
def subjects(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a First and a Second Training and a session, none of whose settings is the usual one."""
    folder = tmp_path_factory.mktemp("odd")
    first, second = odd(STEPPING.episode), odd(BALANCE.episode)
    trained(folder / "first", TrainingConfig(STEPPING, episodes=1, episode=first), LEGS)
    trained(folder / "second", TrainingConfig(BALANCE, episodes=1, episode=second), HIPS)
    shared = {name: value for name, value in vars(second).items() if name != "stepping"}
    operation = OperationConfig(PushedConfig(**shared), 0.5, *(0.5, 0.6, 0.7, 0.8))
    session = SessionFolder.create(folder / "session", SessionSpec((*LEGS, *HIPS), "none", 0, operation))
    session.append_window(Window(0, 0.0, 2.1, 0, (*LEGS, *HIPS), 0.5, 0.5, False, (0.0,) * len(FELT)))
    session.write_parameters((*LEGS, *HIPS))
    for config in (first, second):
        usual = settings_by_key(type(config)())
        left = {key for key, value in settings_by_key(config).items() if value == usual.get(key)}
        assert left <= {"terrain.roughness"} | ({"engine"} if ENGINE is None else set())
    return folder


NEEDS = {"sarah-view": ("viser",), "sarah-video": ("pybullet",), "sarah-transfer": ("pybullet", "mujoco")}
DRAWN = (
    *((all_figures, name) for name in ("draw_figures", "draw_robot", "draw_state_machine", "draw_gait_cycle")),
    *((terrain_figure, "draw_terrain"), (training_figures, "draw_survival"), (transfer_figure, "draw_transfer")),
    *((session_figure, "draw_session"), (dimension_figure, "draw_dimensions")),
)


@dataclasses.dataclass
class Ran:
    configs: list[EpisodeConfig] = dataclasses.field(default_factory=list)
    legs: list[SteppingParameters] = dataclasses.field(default_factory=list)
    drawn: list[object] = dataclasses.field(default_factory=list)
    printed: str = ""


@pytest.fixture
def ran(subjects: Path, tmp_path: Path, monkeypatch: MonkeyPatch) -> Callable[[str], Ran]:
    """Runs a command line in this process: settings and P1 to P5 of all that it simulates, and what it shows."""
    found = Ran()
    build, set_parameters = RunningRobot.__init__, PatternGenerator.set_parameters

    def built(robot: RunningRobot, config: EpisodeConfig, *arguments: Any, **keywords: Any) -> None:
        found.configs.append(config)
        build(robot, config, *arguments, **keywords)

    def given(generator: PatternGenerator, stepping: SteppingParameters, *balance: Any) -> None:
        found.legs.append(stepping)
        set_parameters(generator, stepping, *balance)

    def trains(config: TrainingConfig, *_: object) -> None:
        found.configs.append(config.episode)
        found.legs.append(SteppingParameters(*config.episode.stepping))  # type: ignore[attr-defined]
        raise KeyboardInterrupt

    def draw(*arguments: Any) -> list[Path]:
        found.drawn.extend(arguments)
        return [Path("drawn.png")]

    monkeypatch.chdir(tmp_path)
    for name in ("first", "second", "session"):
        Path(name).symlink_to(subjects / name)
    monkeypatch.setattr(RunningRobot, "__init__", built)
    monkeypatch.setattr(PatternGenerator, "set_parameters", given)
    monkeypatch.setattr("sarah.training.train.train", trains)
    monkeypatch.setattr(robustness, "SECONDS_AFTER", 0.1)
    monkeypatch.setattr(terrain, "TIME_LIMIT", 1.2)
    level = [terrain.Situation("slope", 0.0, "", newtons) for newtons in (0.0, 75.0)]
    monkeypatch.setattr(terrain, "situations", lambda scale: level)
    for module, name in DRAWN:  # which would take most of the time
        monkeypatch.setattr(module, name, draw)

    def ask(line: str) -> Ran:
        command, *arguments = shlex.split(line)
        for package in NEEDS.get(command, ()):
            pytest.importorskip(package)
        process = run(command, *arguments, cwd=tmp_path)
        assert process.returncode in (0, 130), process.stderr  # the training of which only the settings matter
        found.printed = process.stdout
        return found

    return ask


PUSH = {"push", *(f"push.{name}" for name in ("newtons", "degrees", "at_seconds", "duration", "sagittal_share"))}
GROUNDS = ("slope_degrees", "direction_degrees", "cell", "reach", "friction_left", "friction_right")
GROUND = {f"terrain.{name}" for name in GROUNDS}
TABLE = {"time_limit", "payload"}
LADEN = "--episode.payload 3"
SHORT = "--minutes 0.1 --learner none"


@pytest.mark.parametrize(
    ("line", "others"),
    [
        *((f"sarah-eval {subject} --episodes 1", set()) for subject in ("first", "second", "session")),
        ("sarah-video second --out out.gif --seconds 1 1.05", set()),
        ("sarah-video session --out out.gif --seconds 1 1.05", set()),
        ("sarah-view session --out out.html", set()),
        ("sarah-view first --out out.html --which best", set()),
        ("sarah-report second --out out.html --episodes 1 --seconds 1 1.05", set()),
        ("sarah-figures first --out out", set()),
        (f"sarah-transfer second --out out --episodes 1 {LADEN}", {"engine", "physics.added_plate_inertia", "payload"}),
        (f"sarah-eval second --robustness --out out --forces 25 --episodes 1 {LADEN}", PUSH | TABLE),
        (f"sarah-eval first --terrain --out out --episodes 1 {LADEN}", PUSH | GROUND | TABLE),
        (f"sarah-eval second --terrain --out out --episodes 1 {LADEN}", PUSH | GROUND | TABLE),
        (f"sarah-operate first {SHORT} --settle-seconds 0.5 --measure-seconds 0.5", PUSH),
        (f"sarah-operate second {SHORT} --settle-seconds 0.5 --measure-seconds 0.5", PUSH),
        (f"sarah-operate session {SHORT}", set()),
        ("sarah-train --task balance --from first", {"push", "time_limit"}),
    ],
)
def test_what_is_simulated_has_the_settings_of_the_subject(
    line: str, others: set[str], ran: Callable[[str], Ran]
) -> None:
    subject = next(name for name in ("first", "second", "session") if name in line)
    own = settings_by_key(odd(STEPPING.episode if subject == "first" else BALANCE.episode))
    found = ran(line)
    assert found.configs and SteppingParameters(*LEGS) in found.legs
    if subject != "first":  # a report compares P1 to P5 with the paper's
        assert set(found.legs) == {SteppingParameters(*LEGS)}
    if line.startswith(("sarah-figures", "sarah-report")):
        assert describe_robot(CHOSEN["dimensions"]) in found.drawn
        assert odd(STEPPING.episode).controller in found.drawn
    for config in found.configs:
        there = settings_by_key(config)
        changed = {key for key in own | there if key != "stepping" and own.get(key) != there.get(key)}
        if subject == "first":
            changed = {"push" if key in PUSH else key for key in changed}
        assert changed <= others
        for key in changed - {"push.newtons"}:  # which the table itself has
            assert (there[key] if key == "engine" else key) in found.printed


def test_a_subjects_robot_is_described_and_a_session_goes_on(subjects: Path, ran: Callable[[str], Ran]) -> None:
    for described, subject in enumerate(("first", "session"), 1):
        assert ran(f"sarah-describe {subject}").drawn.count(describe_robot(CHOSEN["dimensions"])) == described
    ran(f"sarah-operate session {SHORT} --settle-seconds 0.9 --out out")
    before, after = (SessionFolder.open(path).spec().config for path in (subjects / "session", Path("out")))
    assert after == dataclasses.replace(before, minutes=0.1, settle_seconds=0.9)


def test_an_option_changes_nothing_else_of_a_sessions_windows(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    pytest.importorskip("viser")
    shown: list[RunEpisode] = []

    def page(server: object, choices: list[RunEpisode], chosen: RunEpisode) -> None:
        shown.extend(choices)
        raise KeyboardInterrupt

    monkeypatch.setattr("sarah.viewer.page.Page", page)
    monkeypatch.setattr("sarah.viewer.server.serving", lambda *_: contextlib.nullcontext())
    config = OperationConfig(minutes=0.2, changes=(Change(0.1, {"payload": 5.0}),))
    folder = SessionFolder.create(tmp_path / "session", SessionSpec(config=config))
    for index, each in enumerate(((*LEGS, *HIPS), (*LEGS[::-1], *HIPS))):
        folder.append_window(Window(index, 6.0 * index, 6.0, index, each, 0.5, 0.5, False, (0.0,) * len(FELT)))
    changed = ["--episode.randomisation.friction", "0.5", "--episode.dimensions", "thigh_length", "0.36"]
    assert run("sarah-view", str(folder.path), *changed, cwd=tmp_path).returncode == 130
    windows = [choice.spec.config for choice in shown if choice.name != "best"]
    assert [window.stepping for window in windows] == [LEGS, LEGS[::-1]]  # type: ignore[attr-defined]
    assert [window.payload for window in windows] == [0.0, 5.0]
    randomisation = dataclasses.replace(config.robot.randomisation, friction=(0.5, 0.5))
    assert {window.randomisation for window in windows} == {randomisation}
    assert {window.controller for window in windows} == {config.robot.controller}  # as the folder has it
    assert [dict(window.dimensions) for window in windows] == [{"thigh_length": 0.36}] * 2
