"""What a command says one does next: at most three lines, whose commands work as they stand."""

import shlex
from pathlib import Path
from urllib.parse import unquote, urlparse

import pytest
from terminal import BIN, COARSE, SHORT, Trained, done, run

from sarah.cli import next_steps
from sarah.cli.next_steps import passed_on, say_next, to_see, to_watch
from sarah.episode.spec import FIRST_EVALUATION_SEED

ENDING = {"sarah-view": ("--out", "page.html"), "sarah-eval": ("--episodes", "1")}


def steps_of(said: str) -> dict[str, list[str]]:
    """Words of the commands of the last lines, by their purpose; the path of a program is left out."""
    lines = [line.removeprefix("to ").split(":  ", 1) for line in said.splitlines() if line.startswith("to ")]
    assert said.endswith("\n".join(said.splitlines()[-len(lines) :]) + "\n") and 1 <= len(lines) <= 3
    words = {purpose: shlex.split(command) for purpose, command in lines}
    return {purpose: [Path(program).name, *others] for purpose, (program, *others) in words.items()}


def paste(words: list[str], folder: Path) -> str:
    """What a suggested command prints; one that opens a file, the file."""
    if words[0] == "python":
        assert words[1:3] == ["-m", "webbrowser"]
        file = Path(unquote(urlparse(words[3]).path))
        assert file.stat().st_size > 1000
        return str(file)
    if words[0] == "tensorboard":
        assert words[1] == "--logdir" and list((folder / words[2]).glob("**/events.out.tfevents.*"))
        return ""
    process = done(*words, *ENDING.get(words[0], ()), cwd=folder)
    return process.stdout


def test_a_training_can_be_seen_tested_and_watched(trained: Trained) -> None:
    folder, process = trained
    steps = steps_of(process.stderr)
    assert list(steps) == ["see it", "test it", "watch its curves"] and "sarah-" not in process.stdout.splitlines()[-1]
    assert [words[-1] for words in steps.values()] == ["mine"] * 3
    assert "which no training has seen" in paste(steps["test it"], folder.parent)
    assert paste(steps["watch its curves"], folder.parent) == ""


def test_an_episode_that_was_evaluated_is_seen_under_the_same_conditions(tmp_path: Path) -> None:
    settings = ("--episode.time-limit", "1.5", "--episode.payload", "3", *COARSE)
    steps = steps_of(run("sarah-eval", "0.4,1.3,0.1,1,1", "--episodes", "1", *settings, cwd=tmp_path).stderr)
    assert steps == {"see it": ["sarah-view", "0.4,1.3,0.1,1,1", *settings, "--seed", str(FIRST_EVALUATION_SEED)]}
    assert paste(steps["see it"], tmp_path) == "page.html\n"


RACE = "sarah-compare --out race --algorithms random --seeds 1 --episodes 2 --evaluations 1"
PURPOSES = {
    "sarah-view {run} --out 'a page.html'": ["open it"],
    "sarah-eval {run} --episodes 1": ["see it", "have it on one page"],
    "sarah-operate {run} --learner none --minutes 0.1": ["see it", "test it", "watch its curves"],
    f"{RACE} {' '.join(SHORT)}": ["open it", "see its best", "watch its curves"],
}


@pytest.mark.parametrize("line", PURPOSES)
def test_other_commands_say_what_one_does_next(line: str, trained: Trained, tmp_path: Path) -> None:
    process = done(*shlex.split(line.format(run=trained[0])), cwd=tmp_path)
    steps = steps_of(process.stderr)
    assert list(steps) == PURPOSES[line]
    for purpose in steps.keys() - {"have it on one page"}:
        paste(steps[purpose], tmp_path)


def test_commands_are_quoted_and_aligned(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PATH", str(BIN))
    say_next(to_see(Path("-my run"), "--task", "my task.py:MINE"), to_watch(Path("it's")))
    shown, said = capsys.readouterr()
    assert shown == ""
    assert said.splitlines() == [
        "to see it:            sarah-view './-my run' --task 'my task.py:MINE'",
        "to watch its curves:  tensorboard --logdir 'it'\"'\"'s'",
    ]
    monkeypatch.setenv("PATH", "/nowhere")
    monkeypatch.setattr("sys.argv", [str(BIN / "sarah-train")])
    say_next(to_see(Path("run")))
    assert capsys.readouterr().err == f"to see it:  {BIN / 'sarah-view'} run\n"


def test_a_video_takes_the_place_of_a_viewer_that_is_not_installed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(next_steps, "find_spec", lambda name: None)
    assert to_see("balance") == ("see it", ("sarah-video", "balance", "--out", "episode.gif"))


def test_options_that_another_command_has_not_are_left_out() -> None:
    line = "--json run --episodes 5 --engine mujoco --forces 1 2 --no-randomisation --first_seed=3 --episode.payload 5"
    words = passed_on(line.split(), "run", "json", "episodes", "forces", "first-seed")
    assert words == ["run", "--engine", "mujoco", "--no-randomisation", "--episode.payload", "5"]
