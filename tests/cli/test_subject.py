"""What a command looks at, whatever its options are called; options set settings, and one number is a whole range."""

import dataclasses
import json
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest
from laboratory import RESULT
from pytest import MonkeyPatch
from terminal import COARSE, Begin, Trained, done, run

import sarah
from sarah.cli.episode_options import EpisodeOptions
from sarah.cli.eval_text import rows_of
from sarah.cli.options import parse_options
from sarah.cli.train import TrainOptions
from sarah.episode.evaluation import Evaluation
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push, draw_push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.runs.agent_settings import NAFSettings, TD3Settings
from sarah.runs.config_files import settings_by_key, write_config
from sarah.simulation.engines import default_engine
from sarah.simulation.physics import Physics, PyBulletPhysics

QUICK = ("--episodes", "2", "--json", "--episode.time-limit", "3", *COARSE)
NUMBERS = "1.09,0.17,0.65,1.13"


def shown(*arguments: str, folder: Path) -> dict[str, object]:
    process = done("sarah-eval", *arguments, *QUICK, cwd=folder)
    assert process.stderr == "", process.stderr
    content: dict[str, object] = json.loads(process.stdout)
    return content


@pytest.mark.parametrize("option", ["--task balance", "--episode.push.newtons 60"])  # the name of a set, and numbers
def test_an_option_before_or_after_it_changes_nothing(option: str, tmp_path: Path) -> None:
    assert shown(*option.split(), NUMBERS, folder=tmp_path) == shown(NUMBERS, *option.split(), folder=tmp_path)


def test_shipped_parameters_come_with_their_settings(tmp_path: Path) -> None:
    balance, numbers = PARAMETER_SETS["balance"].spec, ",".join(map(str, PARAMETER_SETS["balance"].spec.parameters))
    own, other = shown("balance", folder=tmp_path), shown(numbers, folder=tmp_path)  # pushed less
    assert own["parameters"] == other["parameters"] and own["score_mean"] != other["score_mean"]
    assert own["episode"]["stepping"] == list(PARAMETER_SETS["stepping"].spec.parameters)  # type: ignore[index]
    assert shown(folder=tmp_path) == own
    low, high = BALANCE.config_of(balance.config).push.newtons
    text = run("sarah-eval", "--help", cwd=tmp_path).stdout
    assert f"{low} {high}" in text and "--episode.stepping" in text


@pytest.mark.parametrize("numbers", ["-1,0,1,0", "1, 0.2, 0.1, 0", " -.5,0,1,-1"])
def test_numbers_as_people_write_them(numbers: str, tmp_path: Path) -> None:
    values = shown(numbers, "--episodes", "1", folder=tmp_path)["parameters"]
    assert list(values.values()) == [float(value) for value in numbers.split(",")]  # type: ignore[attr-defined]


def test_a_run_folder_is_evaluated_as_it_was_trained(trained: Trained, balanced: Path) -> None:
    folder, _ = trained
    process = done("sarah-eval", "mine", "--episodes", "2", cwd=folder.parent)
    for text in ("subject          mine, task stepping", "score            0.", "SHIFT by sensors ", "sole clearance "):
        assert text in process.stdout
    assert "neutral" not in process.stdout
    first = run("sarah-eval", "mine", "--episodes", "2", "--first-seed", "5", "--json", cwd=folder.parent)
    content = json.loads(first.stdout)
    assert [content[key] for key in ("task", "algorithm", "episodes", "first_seed")] == ["stepping", "naf", 2, 5]
    assert content["parameters"] == json.loads((folder / "parameters.json").read_text())["parameters"]
    assert content["episode"]["time_limit"] == 1.5 and "baseline" not in content
    seconds = json.loads(run("sarah-eval", "second", "--episodes", "2", "--json", cwd=balanced.parent).stdout)
    assert seconds["task"] == "balance" and list(seconds["parameters"]) == ["V1", "V2", "V3", "V4"]
    assert seconds["chatters"] is False and seconds["baseline"]["episodes"] == 2 and len(seconds["endings"]) == 2
    outer = run("sarah-eval", str(folder.parent), cwd=folder)
    assert outer.returncode == 2 and f"it has no config.yaml, and {folder} has one" in outer.stderr


def test_options_reach_the_episodes(tmp_path: Path) -> None:
    alone = shown("stepping", folder=tmp_path)
    coarse = sarah.EpisodeConfig(time_limit=3.0, physics=Physics(rate=100, solver_iterations=5))
    plain = [sarah.simulate(EpisodeSpec(TRAINED_STEPPING, seed, config=coarse)).score for seed in (1000, 1001)]
    assert alone["score_mean"] == pytest.approx(sum(plain) / 2) and alone["algorithm"] is None
    pushed = shown("stepping", "--episode.push.newtons", "400", folder=tmp_path)
    assert alone["survival_rate"] == 1.0 and pushed["survival_rate"] == 0.0
    assert shown("stepping", "--no-randomisation", folder=tmp_path)["score_mean"] != alone["score_mean"]
    own = BalanceConfig(engine="pybullet", physics=PyBulletPhysics(rate=400, control_rate=200))
    options = EpisodeOptions(physics="reference", episode=own)
    physics = options.applied_to(EpisodeSpec((0.0,) * 4, 0, BALANCE)).config.physics
    assert physics == PyBulletPhysics(1000, 100, 200, 0.0)


DIRECTED = "--episode.push.degrees 180"


@pytest.mark.parametrize(
    ("asked", "share"), [("", 0.5), (DIRECTED, 0.0), (f"{DIRECTED} --episode.push.sagittal-share=0.2", 0.2)]
)
def test_directions_that_are_asked_for_are_those_of_all_pushes(asked: str, share: float, tmp_path: Path) -> None:
    found = shown("balance", "--episodes", "1", *asked.split(), folder=tmp_path)["episode"]
    assert found["push.sagittal_share"] == share  # type: ignore[index]


def test_it_says_what_was_evaluated_and_how_the_episodes_ended() -> None:
    spec = PARAMETER_SETS["balance"].spec
    push = Push((400.0, 400.0), (0.0, 0.0), (2.0, 3.0))
    changed = BALANCE.config_of(spec.config, push=push, payload=1.5)
    fallen = dataclasses.replace(RESULT, termination="fallen", duration=2.5, vibration=40.0)
    up = dataclasses.replace(RESULT, duration=9.0)
    seeds = range(1000, 1008)
    begins = [draw_push(push, seed).begin for seed in seeds]
    evaluation, baseline = Evaluation((up, *(fallen,) * 7)), Evaluation((up, up, up, fallen))
    used = dataclasses.replace(spec, config=changed)
    rows = dict(rows_of("balance", spec.config, used, seeds, evaluation, baseline))
    assert rows["subject"] == f"balance, task balance, in {default_engine()}, pushed by 400 N"
    assert rows["origin"] == PARAMETER_SETS["balance"].origin and rows["steps with"].startswith("P1 = ")
    assert {"payload 1.5", "push.degrees 0", "push.at_seconds 2 to 3"} <= set(rows["settings"].split(", "))
    assert "push.sagittal_share 0 instead of 0.5" in rows["settings"]
    assert rows["seeds"] == "1000 to 1007, which no training has seen"
    assert rows["parameters"] == ", ".join(f"V{i} = {v:.3f}" for i, v in enumerate(spec.parameters, 1))
    assert rows["survival"].startswith("1 of 8 episodes; seed 1001 fallen; seed 1002 fallen; ")
    assert rows["survival"].endswith("; seed 1005 fallen; 2 more")
    pushed = 1 + sum(begin < 2.5 for begin in begins[1:])
    assert 1 < pushed < 8 and rows["pushes"] == f"in {pushed} of 8 episodes; the others ended before theirs"
    assert rows["vibration"] == "40.0 m²/s⁴ median"
    assert rows["baseline (V = 0)"] == "score 0.800 median, 0.800 mean, 3 of 4 survive, 3.00 steps/s"
    assert rows["chatter"] == "the hips chatter: a vibration of 40.0 m²/s⁴, and of 9.0 with the baseline"


def test_it_says_nothing_of_what_is_as_usual() -> None:
    spec = EpisodeSpec(TRAINED_STEPPING, 0)
    rows = dict(rows_of("1,2", spec.config, spec, range(5, 6), Evaluation((RESULT,)), None))
    assert rows["subject"].endswith("not pushed") and rows["seeds"].startswith("5, which")
    assert rows["survival"] == "1 of 1 episodes"
    assert not {"origin", "steps with", "settings", "pushes", "chatter", "physics"} & set(rows)
    fallen = Evaluation((dataclasses.replace(RESULT, termination="fallen"),) * 5)
    assert dict(rows_of("1,2", spec.config, spec, range(5), fallen, None))["survival"].count("seed") == 5
    still = dataclasses.replace(spec, task=dataclasses.replace(STEPPING, neutral=(1.0,) * 5))
    rows = dict(rows_of("1,2", spec.config, still, range(1), Evaluation((RESULT,)), Evaluation((RESULT,))))
    assert rows["neutral"] and rows["chatter"].startswith("no chatter: ")
    soft = dataclasses.replace(PARAMETER_SETS["balance"].spec, config=BalanceConfig(push=Push(0.0)))
    early = Evaluation((dataclasses.replace(RESULT, duration=1.0),))
    assert "pushes" not in dict(rows_of("x", soft.config, soft, range(1), early, None))


@pytest.mark.parametrize(("host", "warned"), [("127.0.0.1", False), ("0.0.0.0", True)])
def test_the_page_says_where_it_is_and_what_it_shows(
    host: str, warned: bool, tmp_path: Path, monkeypatch: MonkeyPatch
) -> None:
    pytest.importorskip("viser")

    def wait(_: object) -> None:
        raise KeyboardInterrupt

    closed: list[bool] = []
    page, server = SimpleNamespace(close=lambda: closed.append(True)), SimpleNamespace(get_port=lambda: 8083)
    monkeypatch.setattr("sarah.viewer.page.Page", lambda *_: page)
    monkeypatch.setattr("sarah.viewer.server.serving", lambda *_: nullcontext(server))
    monkeypatch.setattr("threading.Event.wait", wait)
    lines = run("sarah-view", "--host", host, cwd=tmp_path).stdout.splitlines()
    assert lines[0] == f"balance: {PARAMETER_SETS['balance'].origin}"
    assert lines[-1] == f"SARAH is at http://{host}:8083 (Ctrl-C ends)" and closed
    assert [line for line in lines if "no password" in line] == lines[1:-1] and len(lines) == 2 + warned


def test_options_set_the_agent_and_a_file_repeats_it(begun: Begin) -> None:
    config = begun("sarah-train --agent.preset paper --agent.mu-layers 8 --agent.learning-rate 1e-4")
    assert config.agent == NAFSettings(preset="paper", mu_layers=(8,), learning_rate=1e-4)
    config = begun("sarah-train --algo td3 --agent.layers 8 8 --agent.learning-starts 8")
    assert config.agent == TD3Settings(layers=(8, 8), learning_starts=8)
    write_config(config, Path("td3.yaml"))
    assert begun("sarah-train --config td3.yaml") == config
    again = begun("sarah-train --config td3.yaml --agent.gradient-steps 9").agent
    assert again == TD3Settings(layers=(8, 8), learning_starts=8, gradient_steps=9)


def test_the_command_line_changes_the_file(begun: Begin) -> None:
    Path("mine.yaml").write_text("agent: {tau: 0.1, v_layers: [4], preset: paper, l_layers: [4]}")
    same = begun("sarah-train --config mine.yaml --agent.preset paper --agent.l-layers 5").agent
    assert same == NAFSettings(preset="paper", tau=0.1, v_layers=(4,), l_layers=(5,))
    assert begun("sarah-train --config mine.yaml --agent.preset one-step").agent == NAFSettings(tau=0.1)
    assert begun("sarah-train --config mine.yaml --algo td3").agent == TD3Settings()


HELP = {
    "--help": (("--agent.elite-share", "(0 to 1; default: ", "{one-step,noisy,paper}"), "--agent.layers"),
    "--algo td3 --help": (("--agent.layers", "--agent.policy-delay"), "--agent.elite-share"),
    "--algo=cma-es --help": (("--agent.population",), "--agent.learning-rate"),
    "--algo random --help": (("--episode.time-limit",), "--agent."),
}


@pytest.mark.parametrize("arguments", HELP)
def test_the_help_shows_the_settings_of_the_algorithm(arguments: str, tmp_path: Path) -> None:
    shown, hidden = HELP[arguments]
    process = done("sarah-train", *arguments.split(), cwd=tmp_path)
    assert all(text in process.stdout for text in shown) and hidden not in process.stdout


PUSHED = EpisodeOptions(episode=sarah.PushedConfig())


RANGES: dict[str, dict[str, list[float]]] = {
    "--episode.push.newtons 80": {"push.newtons": [80.0, 80.0]},
    "--episode.push.newtons=80": {"push.newtons": [80.0, 80.0]},
    "--episode.push.newtons 1e1 2e1": {"push.newtons": [10.0, 20.0]},
    "--episode.push.newtons 80 --engine pybullet": {"push.newtons": [80.0, 80.0]},
    "--episode.push.at_seconds 3 --episode.push.degrees 0 90": {"push.at_seconds": [3, 3], "push.degrees": [0, 90]},
    "--episode.randomisation.actuator_bandwidth 40": {"randomisation.actuator_bandwidth": [40.0, 40.0]},
    "--episode.terrain.slope-degrees 0 5": {"terrain.slope_degrees": [0.0, 5.0]},
}


@pytest.mark.parametrize("words", RANGES)
def test_one_number_is_a_range_on_the_command_line(words: str) -> None:
    episode = parse_options(EpisodeOptions, "sarah-eval", words.split(), PUSHED).episode
    assert RANGES[words].items() <= settings_by_key(episode).items()
    train = parse_options(TrainOptions, "sarah-train", ["--agent.exploration-std", "0.2"], TrainOptions())
    assert train.training.agent.exploration_std == (0.2, 0.2)  # type: ignore[attr-defined]
