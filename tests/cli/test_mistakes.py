"""What a user can get wrong with a command is answered in one line that names it, and nothing is written."""

import os
import subprocess
from pathlib import Path

import pytest
from laboratory import need
from logged import write
from pytest import CaptureFixture, MonkeyPatch
from terminal import BIN, Answer

from sarah.cli.options import as_command
from sarah.episode.settings import EpisodeConfig
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder

GIVEN, PUSHED = "1,1,1,1,1", "1,0,1,0"
PUSH_AT = "--episode.push.newtons 80 --episode.push.at-seconds"
MISTAKES = {
    "sarah-train": [
        ("--task steping", "unknown task 'steping', did you mean 'stepping'?"),
        ("--engine mujco", "unknown --engine/--episode.engine 'mujco', did you mean 'mujoco'?"),
        ("--episods 5", "did you mean --episodes?"),
        ("--episode 5", "did you mean --episodes?"),
        ("balance", "'balance' is no option: a task is given as --task balance"),
        ("--task", "--task"),
        ("--task my_task.py:THIFTY", "unknown task in my_task.py 'THIFTY', did you mean 'THRIFTY'?"),
        ("--task my_task.py", "name the task in my_task.py too, as in my_task.py:TASK"),
        ("--task nowhere.py:JUMP", "cannot read nowhere.py: No such file or directory"),
        ("--out x --simulations=0", "episodes must be between 1 and 1000000, not 0"),
        ("--episode.dimensions thigh_length", "must be names and numbers in turn, and 'thigh_length' has no number"),
        ("--task balance --episode.push.newtons", "--episode.push.newtons must be one number, or two for a range"),
        ("--task balance --episode.push.newtons 50 20", "between 0 and 10000 N and in rising order"),
        ("--task balance --episode.stepping 1 1 1", "--episode.stepping"),
        ("--task balance --episode.time-limit 1.5 --episode.push.at-seconds 2 3", "before the time_limit of 1.5 s"),
        ("--task stepping --episode.push.newtons 50 60", "--episode.push.newtons is for --task balance"),
        ("--engine mujoco --episode.physics.added-plate-inertia 0.01", "--episode.physics.added-plate-inertia"),
        ("--from full", "--from is for --task balance, not 'stepping'"),
        ("--workers 2 --scheduler tcp://127.0.0.1:9", "give one of the two"),
        ("--scheduler nonsense", "no Dask scheduler answers at 'nonsense'"),
        ("--out full --workers 1000", "run folder full is not empty: name another with --out"),
        ("--out full/precious.txt", "cannot write run folder"),
        ("--resume full", "full is not the folder of a training: it has no config.yaml"),
        ("--agent.v-layers 8 x", "--agent.v-layers must be whole numbers, not ['8', 'x']"),
        ("--algo td3 --agent.preset paper", "--agent.preset is for --algo naf, not 'td3'"),
        ("--algo sac --agent.no-squash-mu", "--agent.no-squash-mu is for --algo naf, not 'sac'"),
        ("--agent.net-arch 8", "did you mean --agent.v-layers or --agent.mu-layers or --agent.l-layers?"),
        ("--algo td3 --agent.net_arch=8", "of --algo td3, did you mean --agent.layers? (allowed: --agent.learning-rat"),
        ("--agent.layers 8", "is for --algo td3 or sac or ddpg, not 'naf', did you mean --agent.v-layers or"),
        ("--algo td3 --agent.exploration-std 0.1", "not 'td3', did you mean --agent.action-noise-std?"),
        ("--algo tpe --agent.x 1", "unknown option --agent.x of --algo tpe (allowed: none)"),
        ("--algo sac --agent.ent-coef high", "--agent.ent-coef must be FLOAT|{auto}, not ['high']"),
    ],
    "sarah-compare": [
        ("", "give a folder for the race: --out DIR"),
        ("--out race --algorithms", "algorithms"),
        ("--out race --algorithms naf naf", "algorithms must be different ones"),
        ("--out race --algorithms naf tpee", "unknown algo 'tpee', did you mean 'tpe'?"),
        ("--out race --best-known 3", "best-known must be between 0.01 and 2, not 3.0"),
        ("--out race --evaluations 0", "evaluations must be between 1 and 1000, not 0"),
        ("--out race --evaluations 9 --evaluations-along 10", "evaluations-along must be between 1 and 9, not 10"),
        ("--out race --seeds 0", "seeds must be between 1 and 1000, not 0"),
    ],
    "sarah-eval": [
        ("full", "not the folder of a finished training"),
        ("steping", "did you mean 'stepping'?"),
        ("--task stepping", "'balance' are parameters of task 'balance': give others, or leave --task out"),
        (f"full {GIVEN}", "Unrecognized options: 1,1,1,1,1"),
        ("1,0,1,0 --task my_task.py:THRIFTY", "must be 5 numbers (P1 to P5), not 4"),
        ("1;1;1;1;1", "parameters must be numbers separated by commas, not '1;1;1;1;1'"),
        (f"{GIVEN} --episodes 0", "episodes must be between 1 and 1000000, not 0"),
        (f"{GIVEN} --first-seed -1", "first_seed must be between 0 and 4294967295, not -1"),
        (f"{GIVEN} --engine mujoco --episode.engine=pybullet", "--engine and --episode.engine set the same"),
        (f"stepping --episode.time-limit 3 {PUSH_AT} 5", "must begin before the time_limit of 3 s"),
        ("--episode.push.newtons 100,125", "must be one number, or two for a range, not 100,125"),
        (f"{GIVEN} --episode.terrain.roughness 0 0.01 0.02", "or two for a range, not 0 0.01 0.02"),
        ("--no-randomisation --episode.randomisation.friction 1", "leaves --episode.randomisation.friction without"),
        ("--terrain", "--terrain needs a folder for table and picture: --out DIR"),
        ("--out x", "--out is the folder of --robustness or --terrain: give one of them"),
        ("--terrain --out=", "--out must not be empty"),
        ("''", "an argument must not be empty"),
        (f"{GIVEN} --terrain --out caf\udce9", "--out must be UTF-8 text without control characters, not 'caf\\udce9'"),
        (f"{GIVEN} --json --robustness --out x", "--robustness prints a table, not JSON: leave --json out"),
        (f"{GIVEN} --robustness --out x", "needs parameters of task 'balance', and these are of 'stepping'"),
        (f"{PUSHED} --robustness --out full/precious.txt", "cannot write folder full/"),
        (f"{GIVEN} --forces 0 50", "forces must be between 0.01 and 10000 N, not 0.0"),
        (f"{GIVEN} --forces 100", "--forces is for --robustness"),
        (f"{PUSHED} --robustness --out x --forces abc", "--forces must be numbers, not"),
        (f"{PUSHED} --robustness --out x --episode.time_limit=5", "has pushes and a time limit of its own: leave --ep"),
        ("stepping --terrain --out x --episode.push.degrees 1", "has ground, pushes and a time limit of its own: leav"),
        ("runs/nothing", "there is neither a run folder nor a log 'runs/nothing'"),
    ],
    "sarah-describe": [
        ("--episode.dimensions tigh_length 0.3", "did you mean 'thigh_length'"),
        ("nobody", "'nobody' is neither a run folder, nor numbers"),
        ("balance --config mine/config.yaml", "give --config or a subject, not both"),
    ],
    "sarah-figures": [
        ("", "give at least one run folder"),
        ("full", "not the folder of a finished training"),
        ("full full", "several runs need a folder for their figures: --out DIR"),
    ],
    "sarah-report": [
        ("", "give a run folder"),
        ("full --episodes 0", "episodes must be at least 1, not 0"),
        ("full --seconds 2 2", "seconds must be in rising order, not (2.0, 2.0)"),
    ],
    "sarah-video": [
        ("", "give a run folder, numbers or a name, and the file to write"),
        ("full --out a.gif", "full is not the folder of a training"),
        (f"{GIVEN} --out nowhere/out.mp4", "folder nowhere does not exist"),
        (f"{GIVEN} --out a.gif --which best", "--which is for a run folder"),
        (f"{GIVEN} --out a.gif --speed 0", "speed must be between 0.01 and 10, not 0.0"),
        (f"{GIVEN} --out a.gif --seconds 2 2", "seconds must be two times in rising order, not (2.0, 2.0)"),
        (f"{GIVEN} --out a.gif --seconds 1 0100", "--seconds must be one number, or two for a range, not 1 0100"),
        (f"{GIVEN} --out a.gif --episode.time-limit 1.5 --seconds 2 3", "nothing to film: the episode runs from 1 s"),
    ],
    "sarah-view": [
        ("full", "full is not the folder of a training"),
        ("--port 0", "port must be between 1 and 65535, not 0"),
        ("--host nonsense.invalid", "cannot serve a page at 'nonsense.invalid'"),
        ("--out full", "cannot write full: it is a folder"),
        ("--out a.png", "an exported page must end in .html, not 'a.png'"),
    ],
    "sarah-operate": [
        ("--push-seconds 0.5 --episode.push.duration 5", "push.duration must be at most the 0.5 s"),
        ("--change 5", 'change must be a minute and a setting, such as "5: '),
        ("--change '5: pay_load=3'", "unknown key 'pay_load', did you mean 'payload'?"),
        ("--episode.time_limit 5", "--episode.time_limit has no effect in an operation"),
        ("--episode.push.at-seconds=2", "has no effect in an operation: leave it out"),
        ("--gone-seconds 5", "it needs --robot"),
        ("--learner none --compare-frozen", "--compare-frozen is for a session that learns"),
        ("--resume nowhere --seed 3", "leave '--seed' out"),
    ],
    "sarah-push": [
        ("", "give one of parameters, --stand, --step and --state"),
        ("0.4,1.3", "parameters must be 5 numbers (P1 to P5), 4 (V1 to V4) or 9, not 2"),
        ("0.4,x", "parameters must be numbers separated by commas, not '0.4,x'"),
        ("3,0,0,0", "parameter V1 must be between -2 and 2, not 3.0"),
        ("--state --to tcp/127.0.0.1:9", "no robot listens at tcp/127.0.0.1:9"),
        ("--state --to tls/127.0.0.1:9 --key me.key", "give --authority, --certificate and --key"),
    ],
    "sarah-robot": [
        ("balance --fault 'one pad: 1 N'", "unknown fault 'one pad: 1 N', did you mean 'one pad: 0 N'?"),
        ("balance --driver a.py:ROBOT", "--driver needs --real-time: a robot's time passes by the clock"),
        ("balance --driver a.py:ROBOT --real-time", "there is no file a.py with a driver"),
        ("balance --driver a.py:ROBOT --fault 'all pads: 0 N'", "--fault is for the simulated robot"),
        ("balance --driver a.py:ROBOT --real-time --engine mujoco", "--engine is for the simulated robot"),
        ("balance --stand --no-supervisor", "--stand needs a supervisor: leave --no-supervisor out"),
        ("balance --listen --no-supervisor", "--listen needs a supervisor: leave --no-supervisor out"),
        ("--listen tcp/0.0.0.0:7447", "tcp/0.0.0.0:7447 can be reached from other machines"),
        ("--lockstep", "it needs --listen"),
        ("--lockstep --listen --real-time", "leave out --lockstep or --real-time"),
    ],
    "sarah-operate --robot tcp/127.0.0.1:9": [
        ("--seed 3", "no robot listens at tcp/127.0.0.1:9"),
        *(
            (given, f"{given.split()[0]} has no effect on a robot that runs by itself: leave it or --robot out")
            for given in (
                "--engine mujoco",
                "--episode.payload 5",
                "--physics reference",
                "--change '1: payload=5'",
                "--compare-frozen",
                "--fall-seconds 5",
                "--push-seconds 5",
                "--log a.mcap",
            )
        ),
    ],
    "sarah-log": [
        ("", "give at least one log"),
        ("nowhere.mcap", "cannot read nowhere.mcap: No such file or directory"),
        (".", "cannot read .: it is not a regular file"),
        ("my_task.py", "my_task.py is not an MCAP file"),
        ("a.mcap --chek", "did you mean --check?"),
        ("a.mcap --cut 1 2", "--cut and --out belong together: --cut BEGIN END --out FILE"),
        ("a.mcap --cut 2 1 --out b.mcap", "cut must be two times in rising order, not (2.0, 1.0)"),
        ("a.mcap --cut 2 3 --out b.mcap", "a.mcap has no message from 2 to 3 s"),
        ("a.mcap --cut 0 1 --out a.mcap", "a.mcap is there already: name another file for the log"),
        ("a.mcap a.mcap --csv tables", "--csv takes one log, not 2"),
        ("a.mcap --check --csv tables", "give --check or --csv, not both"),
        ("a.mcap --csv my_task.py", "cannot write folder my_task.py: File exists"),
    ],
    "sarah-train --resume mine": [
        ("--algo naf", "algo is 'random' in this training, not 'naf': leave it out"),
        ("--task balance", "task is 'stepping' in this training, not 'balance': leave it out"),
        ("--slots 2", "slots is 4 in this training, not 2: leave it out"),
        ("--engine mujoco", "not 'mujoco'"),
        ("--episode.time-limit 9", "episode.time_limit is 30.0 in this"),
        ("--out x", "leave --out, --config and --from out"),
        ("--episodes 200", "it can be extended once it is finished: leave --episodes out"),
    ],
    "sarah-transfer": [
        ("", "give at least one run folder, numbers or a name"),
        ("full full", "anything but one run needs a folder for table and figure: --out DIR"),
    ],
}


NEEDS = {"sarah-transfer": ("pybullet", "mujoco"), "sarah-robot": ("mujoco",)}
OWN = "import dataclasses, sarah\nTHRIFTY = dataclasses.replace(sarah.STEPPING, name='thrifty')\n"


@pytest.mark.parametrize(
    ("line", "message"), [(f"{command} {rest}", text) for command, all_ in MISTAKES.items() for rest, text in all_]
)
def test_mistakes_get_one_line_and_leave_everything_alone(
    line: str, message: str, answer: Answer, tmp_path: Path
) -> None:
    for engine in NEEDS.get(line.split()[0], ()):
        need(engine)
    if "tcp/" in line:
        pytest.importorskip("zenoh")
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "precious.txt").write_text("data")
    (tmp_path / "my_task.py").write_text(OWN)
    if " mine" in line:
        need("pybullet")
        config = TrainingConfig(algo="random", episode=EpisodeConfig(engine="pybullet"))
        RunFolder.create(tmp_path / "mine", config)
    if line.startswith("sarah-log"):
        write(tmp_path / "a.mcap")
    assert message in answer(line)


def test_a_plain_terminal_gets_one_line_too(tmp_path: Path) -> None:
    environment = {**os.environ, "LC_ALL": "C", "PYTHONIOENCODING": "ascii"}
    command = [str(BIN / "sarah-eval"), "--nonsense"]
    process = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path, env=environment)
    assert (process.returncode, process.stdout) == (2, "")
    assert process.stderr == "sarah-eval: error: Unrecognized options: --nonsense\n"


def test_a_working_folder_that_is_gone(tmp_path: Path, monkeypatch: MonkeyPatch, capsys: CaptureFixture[str]) -> None:
    folder = tmp_path / "gone"
    folder.mkdir()
    monkeypatch.chdir(folder)
    folder.rmdir()
    with pytest.raises(SystemExit, match="2"), as_command("sarah-eval"):
        pass
    assert capsys.readouterr().err == "sarah-eval: error: [Errno 2] No such file or directory\n"
