"""What a user can get wrong with the other commands is answered in one line that names it, and nothing is written."""

import os
import subprocess
from collections.abc import Callable
from pathlib import Path

import pytest
from laboratory import NEEDS_PYBULLET, need
from terminal import BIN, tree

from sarah.cli.options import as_command

GIVEN, PUSHED = "1,1,1,1,1", "1,0,1,0"
MISTAKES = {
    "sarah-compare": [
        ("", "give a folder for the race: --out DIR"),
        ("--out full/precious.txt --seeds 1", "full/precious.txt"),
        ("--out race --algorithms", "algorithms"),
        ("--out race --algorithms naf naf", "algorithms must be different ones"),
        ("--out race --algorithms naf tpee", "unknown algo 'tpee', did you mean 'tpe'?"),
        ("--out race --best-known high", "--best-known"),
        ("--out race --best-known nan", "--best-known must be a number, not 'nan'"),
        ("--out race --engine bullet", "unknown --engine/--episode.engine 'bullet', did you mean 'pybullet'?"),
        ("--out race --episode.dimensions thigh_length 33", "must be a number between 0.033 and 3.3 m, not 33.0"),
        ("--out race --episode.push.newtons 1 2", "--episode.push.newtons is for --task balance"),
        ("--out race --episodes 0", "episodes must be between 1 and 1000000, not 0"),
        ("--out race --simulations 0", "episodes must be between 1 and 1000000, not 0"),
        ("--out race --evaluations 0", "evaluations must be between 1 and 1000, not 0"),
        ("--out race --evaluations 9 --evaluations-along 10", "evaluations-along must be between 1 and 9, not 10"),
        ("--out race --first-seed -1", "seed must be between 0 and 2147483647, not -1"),
        ("--out race --seeds -1", "seeds must be between 1 and 1000, not -1"),
        ("--out race --seeds 0", "seeds must be between 1 and 1000, not 0"),
        ("--out race --task step", "unknown task 'step', did you mean 'stepping'?"),
    ],
    "sarah-eval": [
        ("full", "not the folder of a finished training"),
        ("full/precious.txt", "is neither a run folder, nor numbers separated by commas"),
        ("runs/nowhere", "'runs/nowhere' is neither a run folder, nor numbers separated by commas"),
        ("nowhere", "'nowhere' is neither a run folder, nor numbers"),
        ("steping", "did you mean 'stepping'?"),
        ("balance --task stepping", "'balance' are parameters of task 'balance': give others, or leave --task out"),
        ("--task stepping", "'balance' are parameters of task 'balance': give others, or leave --task out"),
        ("full --task steping", "unknown task 'steping', did you mean 'stepping'?"),
        (f"full {GIVEN}", "Unrecognized options: 1,1,1,1,1"),
        ("--task stepping 0.4,1.3,0.1,1", "must be 5 numbers (P1 to P5), not 4"),
        ("0.4,1.3,0.1,1,2.5", "P5 must be between 0 and 2, not 2.5"),
        ("0.4,1.3,0.1,1,nan", "parameters must be numbers separated by commas"),
        ("1,1,1,1,inf", "parameters must be numbers separated by commas"),
        ("1,1,-0.1,1,1", "parameter P3 must be between 0 and 2, not -0.1"),
        ("1,1,1,1,one", "parameters must be numbers separated by commas"),
        ("1;1;1;1;1", "parameters must be numbers separated by commas, not '1;1;1;1;1'"),
        (f"{GIVEN} --engine mujco", "unknown --engine/--episode.engine 'mujco', did you mean 'mujoco'?"),
        (f"{GIVEN} --episodes 0", "episodes must be between 1 and 1000000, not 0"),
        (f"{GIVEN} --episodes 100000000", "episodes must be between 1 and 1000000"),
        (f"{GIVEN} --episodes 0100", "--episodes must be a whole number, not '0100'"),
        (f"{GIVEN} --episodes 2.5", "--episodes must be a whole number, not '2.5'"),
        (f"{GIVEN} --terrain --out caf\udce9", "--out must be UTF-8 text without control characters, not 'caf\\udce9'"),
        (f"{GIVEN} --first-seed -1", "first_seed must be between 0 and 4294967295, not -1"),
        (f"{GIVEN} --first-seed 5000000000", "first_seed must be between 0 and 4294967295"),
        (f"{GIVEN} --physic reference", "Unrecognized options: --physic"),
        (f"{GIVEN} --physics refrence", "unknown physics 'refrence', did you mean 'reference'?"),
        (f"{GIVEN} --engine mujoco --episode.engine=pybullet", "--engine and --episode.engine set the same"),
        (f"{GIVEN} --physics reference --episode.physics.rate 500", "--episode.physics.rate set the same: give one"),
        (f"{GIVEN} --episode.stepping 1 1 1 1 1", "--episode.stepping is for --task balance"),
        (f"{GIVEN} --episode.terrain.slope-degrees 5 2", "terrain.slope_degrees must be between 0 and 45 degrees"),
        (f"{GIVEN} --episode.terrain.slope 5", "did you mean --episode.terrain.slope-degrees?"),
        (f"{PUSHED} --episode.push.sagittal-share 2", "push.sagittal_share must be between 0 and 1, not 2.0"),
        (f"{GIVEN} --forces 0 50", "forces must be between 0.01 and 10000 N, not 0.0"),
        (
            f"{GIVEN} --robustness --out x",
            "--robustness needs parameters of task 'balance', and these are of 'stepping'",
        ),
        ("--terrain --out=", "--out must not be empty"),
        (f"{GIVEN} --json --robustness --out x", "leave --json out"),
        (f"{GIVEN} --forces 100", "--forces is for --robustness"),
        (f"{PUSHED} --robustness --out x --forces abc", "--forces must be numbers, not"),
        (f"{PUSHED} --robustness --out x --episode.push.newtons 50", "leave --episode.push.newtons out"),
        (f"{PUSHED} --robustness --out x --episode.time_limit=5", "leave --episode.time-limit out"),
        (
            f"{GIVEN} --no-randomisation --episode.randomisation.imu-tilt-degrees 5",
            "--no-randomisation leaves --episode.randomisation.imu-tilt-degrees without effect",
        ),
        (f"{GIVEN} --json --terrain --out x", "--terrain prints a table, not JSON: leave --json out"),
        (
            f"{GIVEN} --terrain --out x --episode.terrain.roughness 0.01",
            "--terrain has ground, pushes and a time limit of its own: leave --episode.terrain.roughness out",
        ),
        (f"{GIVEN} --episode.terrain.roughness 10", "terrain.roughness must be between 0 and 0.05 m, not 10.0"),
        (f"{GIVEN} --episode.terrain.friction-left ice", "must be one number, or two for a range, not ice"),
        (f"{GIVEN} --episode.terrain.roughness", "must be one number, or two for a range, not nothing"),
        (
            "--episode.push.newtons 100,125",
            "--episode.push.newtons must be one number, or two for a range, not 100,125",
        ),
        (f"{GIVEN} --episode.terrain.roughness 0 0.01 0.02", "or two for a range, not 0 0.01 0.02"),
        (
            f"{GIVEN} --episode.reward-form symetric",
            "'symetric', did you mean 'symmetric'? (allowed: printed, symmetric)",
        ),
        (f"{GIVEN} --x 0.1", "Unrecognized options: --x"),
        (f"{GIVEN} --no-randomization", "did you mean --no-randomisation?"),
        (f"{GIVEN} --workers -2", "workers must be between 0 and 256, not -2"),
        ("--task walk 1,1,1,1,1", "unknown task 'walk'"),
        ("--task balance 1,1,1,1,1", "must be 4 numbers (V1 to V4) or all 9, not 5"),
        ("--task balance 1,0,1", "must be 4 numbers (V1 to V4) or all 9, not 3"),
        ("--task balance 1,0,1,-3", "V4 must be between -2 and 2, not -3.0"),
        (f"{PUSHED} --episode.push.newtons -5", "push.newtons must be between 0 and 10000 N"),
        (f"{PUSHED} --episode.push.newtons inf", "must be one number, or two for a range, not inf"),
        (f"{PUSHED} --episode.stepping 1 1", "--episode.stepping"),
        (f"{PUSHED} --episode.stepping 1 1 1 1 3", "parameter P5 must be between 0 and 2, not 3.0"),
        (f"{PUSHED} --robustness --out full/precious.txt", "cannot write folder full/"),
    ],
    "sarah-figures": [
        ("", "give at least one run folder"),
        ("full", "not the folder of a finished training"),
        ("full full", "several runs need a folder for their figures: --out DIR"),
        ("--ot x", "Unrecognized options: --ot"),
    ],
    "sarah-report": [("nowhere", "run folder nowhere does not exist")],
    "sarah-video": [
        ("", "give a run folder, numbers or a name, and the file to write"),
        ("full", "give a run folder, numbers or a name, and the file to write"),
        ("full --out a.avi", "must end in .mp4 or .gif, not 'a.avi'"),
        ("full --out a.gif", "full is not the folder of a training"),
        ("full --out nowhere/a.gif", "folder nowhere does not exist"),
        ("nowhere --out a.gif", "'nowhere' is neither a run folder, nor numbers separated by commas"),
        ("1,1,1 --out a.gif", "must be 5 numbers (P1 to P5) or 4 numbers (V1 to V4) or all 9, not 3"),
        ("1,1,1,1,1 --out nowhere/out.mp4", "folder nowhere does not exist"),
        ("1,1,1,1,1 --out out.txt", "must end in .mp4 or .gif, not 'out.txt'"),
        ("1,1,1,1,1 --out a.gif --episode.push.newtons 50 40", "in rising order"),
        ("1,1,1,1,1 --out a.gif --which best", "--which is for a run folder"),
        ("1,1,1,1,1 --out a.gif --speed 0", "speed must be between 0.01 and 10, not 0.0"),
        ("1,1,1,1,1 --out a.gif --seconds 3 2", "seconds must be two times in rising order"),
        ("1,1,1,1,1 --out a.gif --seconds 40 41", "nothing to film"),
        ("1,1,1,1,1 --out a.gif --seconds 1 0100", "--seconds must be one number, or two for a range, not 1 0100"),
        ("1,1,1,1,1 --out caf\udce9.gif", "--out must be UTF-8 text without control characters"),
        ("1,1,1,1,1 --out a.gif --seed -1", "seed must be a whole number from 0, not -1"),
    ],
    "sarah-view": [
        ("full", "full is not the folder of a training"),
        ("nowhere", "'nowhere' is neither a run folder, nor numbers separated by commas"),
        ("1,1", "parameters must be 5 numbers (P1 to P5) or 4 numbers (V1 to V4) or all 9, not 2"),
        ("1,1,1,1,3", "parameter P5 must be between 0 and 2, not 3"),
        ("1,1,1,1,1 --seed -1", "seed must be a whole number from 0, not -1"),
        ("1,1,1,1,1 --which best", "--which is for a run folder"),
        ("--port 0", "port must be between 1 and 65535, not 0"),
        ("--engine mujocco", "unknown --engine/--episode.engine 'mujocco', did you mean 'mujoco'?"),
        ("--host nonsense.invalid", "cannot serve a page at 'nonsense.invalid'"),
        ("--host 203.0.113.1", "cannot serve a page at '203.0.113.1'"),
        ("--out full", "cannot write full: it is a folder"),
        ("--out a.png", "an exported page must end in .html, not 'a.png'"),
        ("--out nowhere/a.html", "cannot write nowhere/a.html: folder nowhere does not exist"),
    ],
}
TRANSFER_MISTAKES = [
    ("", "give at least one run folder, numbers or a name"),
    ("full", "not the folder of a"),
    ("full full", "anything but one run needs a folder for table and figure: --out DIR"),
    ("balance", "anything but one run needs a folder for table and figure: --out DIR"),
    ("full --episodes 0", "episodes must be between 1 and 1000000, not 0"),
    ("full --first-seed -1", "first_seed must be between 0 and 4294967295, not -1"),
]


@pytest.fixture(autouse=True)
def full(tmp_path: Path) -> None:
    """The folder ``full``, with a file that nobody may touch."""
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "precious.txt").write_text("data")


@pytest.mark.parametrize(
    ("line", "message"), [(f"{command} {rest}", text) for command, all_ in MISTAKES.items() for rest, text in all_]
)
def test_mistakes_get_one_line_and_leave_everything_alone(
    line: str, message: str, answer: Callable[[str], str]
) -> None:
    assert message in answer(line)


@NEEDS_PYBULLET
@pytest.mark.parametrize(("arguments", "message"), TRANSFER_MISTAKES)
def test_mistakes_with_both_engines_get_one_line(arguments: str, message: str, answer: Callable[[str], str]) -> None:
    need("mujoco")
    assert message in answer(f"sarah-transfer {arguments}")


@pytest.mark.parametrize("command", ["train", "eval", "figures", "video", "compare", "view", "transfer", "report"])
def test_mistakes_get_one_line_on_a_plain_terminal_too(command: str, tmp_path: Path) -> None:
    before = tree(tmp_path)
    process = subprocess.run(
        [BIN / f"sarah-{command}", "--nonsense"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**os.environ, "LC_ALL": "C", "PYTHONIOENCODING": "ascii"},
    )
    assert process.returncode == 2 and process.stdout == ""
    assert process.stderr == f"sarah-{command}: error: Unrecognized options: --nonsense\n"
    assert tree(tmp_path) == before


def test_a_working_folder_that_is_gone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.chdir(folder)
    folder.rmdir()
    with pytest.raises(SystemExit, match="2"), as_command("sarah-eval"):
        pass
    assert capsys.readouterr().err == "sarah-eval: error: [Errno 2] No such file or directory\n"
