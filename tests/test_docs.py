"""What the site's own build cannot see; `make docs` sees the rest."""

import ast
import json
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import astuple, replace
from importlib import import_module
from inspect import signature
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import yaml
from pytest import CaptureFixture, MonkeyPatch

from sarah.agents import NAF
from sarah.control.hip_law import BalanceParameters
from sarah.episode.episode import simulate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig, load_task
from sarah.robot.description import describe_robot
from sarah.robot.reading import ACTUATED_JOINTS
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config
from sarah.simulation.build import simulator_of
from sarah.simulation.engines import is_installed
from sarah.simulation.randomisation import NOMINAL, Randomisation

ROOT = Path(__file__).parent.parent
AS_DESIGNED = Randomisation(enabled=False)
SET = dict(V1=0.8, V2=0.1, V3=0.2, V4=0.1)
LEARNED: dict[str, dict[str, Any]] = {
    "stepping": {"task": "stepping", "parameters": dict(P1=0.4, P2=1.3, P3=0.1, P4=1.0, P5=1.0), "stepping": None},
    "balance": {"task": "balance", "parameters": SET, "stepping": [0.4, 0.5, 0.6, 1, 1]},
}
"""What a run's parameters.json holds, by task."""


def blocks(page: str, language: str = "python") -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / "docs" / page).read_text(), re.DOTALL)


def run_block(page: str, index: int = 0) -> dict[str, Any]:
    names: dict[str, Any] = {}
    exec(blocks(page)[index], names)
    return names


def headings_of(page: Path) -> set[str]:
    """Anchors of a page's headings, as they lie in the repository."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.DOTALL)
    headings = re.findall(r"^#+ (.+)$", re.sub(r"\[(.+?)\]\(.+?\)", r"\1", text), re.MULTILINE)
    return {re.sub(r"[^\w\- ]", "", heading.lower()).strip().replace(" ", "-") for heading in headings}


def test_links_lead_to_files_and_headings() -> None:
    pages = [*ROOT.glob("*.md"), *ROOT.glob("docs/*.md"), *ROOT.glob("docs/*/*.md"), ROOT / "runs/README.md"]
    own = re.compile(r"\]\((?!http)([^)#\s]*)#?([^)\s]*)\)")
    links = [(page, *link) for page in pages for link in own.findall(page.read_text())]
    places = [(page.parent / file if file else page, anchor) for page, file, anchor in links]
    assert len(places) > 50
    assert [place for place, anchor in places if not place.exists()] == []
    assert [(place, anchor) for place, anchor in places if anchor and anchor not in headings_of(place)] == []


def test_tutorials_and_guides_show_every_command() -> None:
    commands = re.findall(r"^    (sarah-\w+) =", (ROOT / "setup.cfg").read_text(), re.MULTILINE)
    pages = [*ROOT.glob("docs/tutorials/*.md"), *ROOT.glob("docs/how_to/*.md")]
    shown = "\n".join(page.read_text() for page in pages)
    assert commands and [command for command in commands if f"\n    {command} " not in shown] == []


def test_commands_on_pages_have_options_that_exist(monkeypatch: MonkeyPatch, capsys: CaptureFixture[str]) -> None:
    pages = "\n".join(page.read_text().replace("\\\n", " ") for page in (ROOT / "docs").rglob("*.md"))
    shown = re.findall(r"^ *(?:    |\$ )(sarah-\w+) ([^\n]*)", pages, re.MULTILINE)
    options: dict[str, set[str]] = {}
    for command, words in shown:
        options.setdefault(command, set()).update(re.findall(r"(?<=\s)--([\w.-]+)", f" {words}"))
    assert len(options) >= 9
    for command, named in options.items():
        for task in ("stepping", "balance"):
            monkeypatch.setattr(sys, "argv", [command, "--task", task, "--help"])
            with pytest.raises(SystemExit):
                import_module(f"sarah.cli.{command.removeprefix('sarah-')}").main()
        known = set(re.findall(r"--([\w.-]+)", capsys.readouterr().out))
        assert named <= known, command


def test_the_tasks_of_the_tutorial_run(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    thrifty, together, environment = blocks("tutorials/own_task.md")
    for name, block in (("my_task", thrifty), ("together", together)):
        Path(f"{name}.py").write_text(block)
    for reference in ("my_task.py:THRIFTY", "together.py:TOGETHER"):
        task = load_task(reference)
        config = replace(task.episode, time_limit=1.5)
        assert simulate(EpisodeSpec(task.baseline, 0, task, config)).survived
    names: dict[str, Any] = {}
    exec(environment if is_installed("pybullet") else environment.replace("pybullet", "mujoco"), names)
    assert names["env"].unwrapped.config.time_limit == 10.0


def test_the_page_writes_a_robot_like_the_default_one(tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    run_block("how_to/robot.md")
    robot = read_config(TrainingConfig, Path("mine.yaml")).episode
    assert robot.dimensions["thigh_length"] + robot.dimensions["shank_length"] == pytest.approx(0.2)
    assert 30.0 * robot.scale.mass == pytest.approx(4.0)


class Clock:
    """A clock that only sleeping moves, beyond what reading takes."""

    now = 10.0

    def monotonic(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds


@pytest.fixture
def loop() -> dict[str, Any]:
    names = run_block("how_to/real_robot.md", 1)
    names["time"] = Clock()
    return names


@pytest.mark.parametrize("task", LEARNED)
def test_the_loop_for_a_real_robot_drives_as_an_episode_does(task: str, loop: dict[str, Any]) -> None:
    learned = LEARNED[task]
    shared: dict[str, Any] = dict(randomisation=AS_DESIGNED, time_limit=3.0)
    config = EpisodeConfig(**shared)
    if task == BALANCE.name:
        config = BalanceConfig(**shared, stepping=tuple(learned["stepping"]), push=Push(newtons=0.0))
    parameters = tuple(learned["parameters"].values())
    trace = simulate(EpisodeSpec(parameters, 0, task, config), record_trace=True).trace
    assert trace is not None and set(trace.phase) == {"shift", "lift", "land"}
    description = describe_robot()
    robot = simulator_of(config.engine)(description, config.physics, NOMINAL)
    sent: list[tuple[float, ...]] = []

    def send(targets: tuple[float, ...]) -> None:
        sent.append(targets)
        robot.set_targets(targets)
        robot.advance()
        if len(sent) == round(config.time_limit / 0.01):
            raise TimeoutError

    limits = [description.limits[joint] for joint in ACTUATED_JOINTS]
    with pytest.raises(TimeoutError):
        loop["drive"](loop["controller"](learned, limits, 0.01), 0.01, robot.read, send)
    robot.close()
    assert np.array_equal(sent[-len(trace) :], trace.targets) and not np.any(sent[: -len(trace)])


def test_the_loop_says_when_a_reading_is_late_and_ends_at_a_fall(loop: dict[str, Any]) -> None:
    clock, told = loop["time"], []

    class Generator:
        targets = (0.0,) * 6
        has_fallen = False

        def tick(self, reading: None, seconds: float) -> None:
            told.append(seconds)
            self.has_fallen = len(told) == 6

    def read() -> None:
        clock.now += 0.034 if len(told) == 2 else 0.004

    loop["drive"](Generator(), 0.01, read, lambda targets: None)
    assert told == pytest.approx([0.01, 0.01, 0.01, 0.034, 0.01, 0.01])


def test_the_limits_on_the_page_are_the_robots(loop: dict[str, Any], tmp_path: Path, monkeypatch: MonkeyPatch) -> None:
    run = tmp_path / "runs" / "balance" / "naf-s0"
    run.mkdir(parents=True)
    (run / "parameters.json").write_text(json.dumps({**LEARNED["balance"], "control_rate": 200}))
    monkeypatch.chdir(tmp_path)
    names, driven = {**loop, "read": None, "send": None}, []
    names["drive"] = lambda generator, dt, read, send: driven.append(generator)
    exec(blocks("how_to/real_robot.md")[2], names)
    assert names["LIMITS"] == [describe_robot().limits[joint] for joint in ACTUATED_JOINTS]
    assert names["DT"] == 1 / 200
    assert driven[0].generator.hips.parameters == BalanceParameters(0.8, 0.1, 0.2, 0.1)


def test_the_page_takes_parameters_of_any_origin(loop: dict[str, Any]) -> None:
    shipped = json.loads((ROOT / "sarah/episode/parameter_sets.json").read_text())
    limits = [(-1.0, 1.0)] * 6
    p, v = PARAMETER_SETS["stepping"].spec.parameters, PARAMETER_SETS["balance"].spec.parameters
    for name, hips in (("stepping", (0.0,) * 4), ("balance", v)):
        generator = loop["controller"](shipped[name], limits, 0.01)
        generator = generator.generator
        assert astuple(generator.parameters) == p and astuple(generator.hips.parameters) == hips
    names = ("P1", "P2", "P3", "P4", "P5", "V1", "V2", "V3", "V4")
    session = loop["controller"]({"parameters": dict(zip(names, range(9), strict=True))}, limits, 0.01).generator
    assert (*astuple(session.parameters), *astuple(session.hips.parameters)) == tuple(range(9))


def test_a_robot_needs_the_standard_library_alone(tmp_path: Path) -> None:
    shutil.copytree(ROOT / "sarah", tmp_path / "sarah", ignore=shutil.ignore_patterns("__pycache__"))
    subprocess.run(["sh", "-e", "-c", blocks("how_to/real_robot.md", "sh")[0]], cwd=tmp_path, check=True)
    program = """
from sarah.robot.reading import STANDING
import json
supervisor, sent = controller(json.load(open('parameters.json')), [(-1.0, 1.0)] * 6, 0.01), []
def read():  # signals without noise would be frozen ones
    up, noise = (0.0 if len(sent) > 120 else 9.81), 0.001 * (len(sent) % 7)
    return STANDING._replace(acceleration=(9.81 - up + noise, noise, up + noise), angular_rate=(noise,) * 3)
drive(supervisor, 0.01, read, sent.append)
assert supervisor.has_fallen and 120 < len(sent) < 220 and any(sent[-1])
"""
    program = blocks("how_to/real_robot.md")[1] + program
    (tmp_path / "robot" / "program.py").write_text(program)
    (tmp_path / "robot" / "parameters.json").write_text(json.dumps(LEARNED["balance"]))
    # -SE: nothing but the standard library can be imported
    command = [sys.executable, "-SE", "program.py"]
    process = subprocess.run(command, cwd=tmp_path / "robot", capture_output=True, text=True)
    assert process.returncode == 0, process.stderr


def texts_of_the_code() -> Iterator[str]:
    """Every text in the code, what is filled in left out, and the Makefile."""
    agents = (ROOT / "agents").glob("*.py")  # a link leads to them, which the search does not follow
    for path in (*(ROOT / "sarah").rglob("*.py"), *agents):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.JoinedStr):
                parts = (part.value if isinstance(part, ast.Constant) else "…" for part in node.values)
                yield "".join(map(str, parts))
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield node.value
    yield (ROOT / "Makefile").read_text(encoding="utf-8")


def test_messages_on_the_page_of_trouble_are_the_programs_own() -> None:
    rows = re.findall(r"^\| (.+?) \|", (ROOT / "docs/how_to/trouble.md").read_text(encoding="utf-8"), re.MULTILINE)
    shown = [text for row in rows for text in re.findall(r"`([^`]+)`", row) if " " in text and "--pictures" not in text]
    known = list(texts_of_the_code())
    for message in shown:
        parts = [part for part in message.split("…") if part.strip(" :,")]
        assert any(all(part in text for part in parts) for text in known), f"no code says {message!r}"
    assert len(shown) > 20


def test_naf_learns_the_environment_of_the_page_and_goes_on(
    tmp_path: Path, monkeypatch: MonkeyPatch, capsys: CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for block in blocks("how_to/own_environment.md"):
        exec(block.replace("2_500", "510").replace("learn(500", "learn(20"), names)
    assert names["model"].num_timesteps == 530
    assert "return -" in capsys.readouterr().out
    assert {path.name for path in Path("cart").iterdir()} == {"best_model.zip", "last.zip", "replay.pkl", "scales.pkl"}
    held, larger = names["HeldActions"](names["Cart"]()), names["larger_actions"](names["Cart"]())
    plain, cut = names["Cart"](), names["Cart"]()
    for env in (held, larger, plain, cut):
        env.reset(seed=0)
    rewards = [plain.step([0.2])[1] for _ in range(4)]
    assert held.step([0.2])[1] == pytest.approx(np.mean(rewards))
    assert larger.step(np.array([0.9], np.float32))[1] == pytest.approx(cut.step([1.0])[1])


def test_naf_takes_the_arguments_of_the_page_on_rl_zoo() -> None:
    (text,) = blocks("how_to/rl_zoo.md", "yaml")
    for name, arguments in yaml.safe_load(text).items():
        assert arguments.pop("n_timesteps") > 0
        policy_kwargs = eval(arguments.pop("policy_kwargs", "dict()"))
        NAF(env="Pendulum-v1" if name == "default" else name, policy_kwargs=policy_kwargs, **arguments)
    program = blocks("how_to/rl_zoo.md")[0]
    tuned = re.findall(r'trial\.suggest_\w+\("(\w+)"', program)
    made_of = {"one_minus_gamma": "gamma", "batch_size_pow": "batch_size", "net_arch": "policy_kwargs"}  # by RL Zoo
    assert {made_of.get(name, name) for name in tuned} <= set(signature(NAF).parameters) and len(tuned) == 6


def test_trainings_of_the_page_on_rl_zoo_are_evaluated_before_they_end() -> None:
    page = (ROOT / "docs/how_to/rl_zoo.md").read_text().replace("\\\n", "")
    steps = yaml.safe_load(blocks("how_to/rl_zoo.md", "yaml")[0])["Pendulum-v1"]["n_timesteps"]
    trainings = [line for line in page.splitlines() if line.startswith("python zoo.py") and "--optimize" not in line]
    frequencies = [int(every) for line in trainings for every in re.findall(r"--eval-freq (\d+)", line)]
    assert len(frequencies) == len(trainings) == 2 and max(frequencies) < steps


def test_the_page_of_the_library_links_every_public_name() -> None:
    links = re.findall(r"\{py:\w+\}`(?:([\w.]+) <)?([\w.]+)>?`", (ROOT / "docs/reference/api.md").read_text())
    assert links
    for shown, target in links:
        module, name = target.rsplit(".", 1)
        home = import_module(module)
        assert hasattr(home, name), f"{target} does not exist"
        if shown:
            package, alias = shown.rsplit(".", 1)
            assert getattr(import_module(package), alias) is getattr(home, name)
    public = {f"{package}.{name}" for package in ("sarah", "sarah.agents") for name in import_module(package).__all__}
    assert public - {shown for shown, _ in links} == set()


def test_a_loop_logs_and_its_log_is_read(tmp_path: Path, monkeypatch: MonkeyPatch, capsys: CaptureFixture[str]) -> None:
    monkeypatch.chdir(tmp_path)
    run_block("how_to/log.md", 1)
    (tmp_path / "run.mcap").rename("push.mcap")
    assert run_block("how_to/log.md")["values"]["state"] == "standing"
    assert re.fullmatch(r"0 None\n20\S+ whole\n", capsys.readouterr().out)
