"""What a command looks at: its argument, whatever the values of its options are called, and what it says of it."""

import dataclasses
import json
import subprocess
from contextlib import nullcontext
from pathlib import Path
from types import SimpleNamespace

import pytest
from laboratory import RESULT
from terminal import COARSE, run

import sarah
from sarah.cli.episode_options import EpisodeOptions
from sarah.cli.eval_text import rows_of
from sarah.episode.evaluation import Evaluation
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push, draw_push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.simulation.engines import default_engine
from sarah.simulation.physics import Physics, PyBulletPhysics

QUICK = ("--episodes", "2", "--json", "--episode.time-limit", "3", *COARSE)
NUMBERS = "1.09,0.17,0.65,1.13"


def shown(*arguments: str, folder: Path) -> dict[str, object]:
    process = run("sarah-eval", *arguments, *QUICK, cwd=folder)
    assert process.returncode == 0 and process.stderr == "", process.stderr
    content: dict[str, object] = json.loads(process.stdout)
    return content


def test_an_option_before_or_after_it_changes_nothing(tmp_path: Path) -> None:
    task = ("--task", "balance")  # which is also the name of shipped parameters
    assert shown(*task, NUMBERS, folder=tmp_path) == shown(NUMBERS, *task, folder=tmp_path)
    pushed = ("--episode.push.newtons", "60")
    assert shown(*pushed, NUMBERS, folder=tmp_path) == shown(NUMBERS, *pushed, folder=tmp_path)


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


def test_a_run_folder_is_evaluated_as_it_was_trained(
    trained: tuple[Path, subprocess.CompletedProcess[str]], balanced: Path
) -> None:
    folder, _ = trained
    process = run("sarah-eval", "mine", "--episodes", "2", cwd=folder.parent)
    assert process.returncode == 0, process.stderr
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
    exact = shown("stepping", "--no-randomisation", folder=tmp_path)
    assert exact["score_mean"] != alone["score_mean"] and exact["survival_rate"] == 1.0
    own = BalanceConfig(engine="pybullet", physics=PyBulletPhysics(rate=400, control_rate=200))
    options = EpisodeOptions(physics="reference", episode=own)
    physics = options.applied_to(EpisodeSpec((0.0,) * 4, 0, BALANCE)).config.physics
    assert physics == PyBulletPhysics(1000, 100, 200, 0.0)


@pytest.mark.parametrize(
    ("asked", "share"),
    [
        ("", 0.5),
        ("--episode.push.degrees 180", 0.0),
        ("--episode.push.degrees 180 --episode.push.sagittal-share=0.2", 0.2),
    ],
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
def test_the_page_says_where_it_is_and_where_shipped_parameters_come_from(
    host: str, warned: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
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
