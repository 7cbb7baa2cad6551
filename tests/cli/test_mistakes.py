"""What a user can get wrong is answered in one line that names it, and nothing is written."""

import json
import shlex
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import pytest
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import NEEDS_PYBULLET, need

from sarah.errors import ConfigurationError
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config
from sarah.runs.run_folder import RunFolder

PARAMETERS = {f"P{index}": 1.0 for index in range(1, 6)}
EPISODE = "index,return,steps_per_second,x,y,P1,P2,P3,P4,P5\n0,1,1,0,0,1,1,1,1,1\n"


@pytest.fixture
def answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Callable[[str], str]:
    """Runs a command line in this process, in a folder of its own, and returns its one line."""
    monkeypatch.chdir(tmp_path)

    def ask(line: str) -> str:
        command, *arguments = shlex.split(line)
        before = tree(tmp_path)
        monkeypatch.setattr("sys.argv", [command, *arguments])
        with pytest.raises(SystemExit) as ended:
            import_module(f"sarah.cli.{command.removeprefix('sarah-')}").main()
        captured = capsys.readouterr()
        assert ended.value.code == 2 and captured.out == ""
        (message,) = captured.err.splitlines()
        assert message.startswith(f"{command}: error: ") and len(message) < 1000
        assert tree(tmp_path) == before
        return message

    return ask


def tree(folder: Path) -> dict[str, bytes]:
    return {str(path): path.read_bytes() if path.is_file() else b"" for path in sorted(folder.rglob("*"))}


TRAIN, EVAL, COMPARE = "sarah-train", "sarah-eval --parameters 1,1,1,1,1", "sarah-compare race"
BALANCE_EVAL = "sarah-eval --task balance --parameters 1,0,1,0"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        # Unknown names
        (f"{TRAIN} --task balence", "unknown task 'balence', did you mean 'balance'?"),
        (f"{TRAIN} --algo cmaes", "unknown algo 'cmaes', did you mean 'cma-es'?"),
        (f"{TRAIN} --episode.phisics.rate 300", "did you mean --episode.physics.rate?"),
        (f"{TRAIN} --episode.reward-form print", "--episode.reward-form"),
        (f"{TRAIN} --episode.dimensions foot_length 0.2", "unknown robot dimension 'foot_length'"),
        (f"{TRAIN} balance", "Unrecognized options: balance"),
        (f"{EVAL} --physic reference", "did you mean --physics?"),
        (f"{EVAL} --physics refrence", "unknown physics 'refrence', did you mean 'reference'?"),
        (f"{COMPARE} --algorithms naf tpee", "unknown algo 'tpee', did you mean 'tpe'?"),
        (f"{COMPARE} --task step", "unknown task 'step', did you mean 'stepping'?"),
        ("sarah-figures --ot x", "Unrecognized options: --ot"),
        # Wrong types
        (f"{TRAIN} --episodes 1e3", "--episodes must be a whole number, not '1e3'"),
        (f"{TRAIN} --episodes 10.5", "--episodes must be a whole number, not '10.5'"),
        (f"{TRAIN} --seed x", "--seed must be a whole number, not 'x'"),
        (f"{TRAIN} --slots", "--slots"),
        (f"{TRAIN} --episode.time-limit 30s", "--episode.time-limit must be a number, not '30s'"),
        (f"{TRAIN} --episode.stepping 1 1 1", "--episode.stepping"),
        (f"{TRAIN} --episode.push.newtons 50", "--episode.push.newtons"),
        (f"{TRAIN} --workers two", "--workers must be a whole number, not 'two'"),
        (f"{EVAL} --episodes 2.5", "--episodes must be a whole number, not '2.5'"),
        ("sarah-eval --parameters 1;1;1;1;1", "parameters must be numbers separated by commas, not '1;1;1;1;1'"),
        ("sarah-eval --parameters 1,1,1,1,one", "parameters must be numbers separated by commas"),
        (f"{COMPARE} --best-known high", "--best-known"),
        # Out of any plausible range
        (f"{TRAIN} --episodes 100000000", "simulations must be between 1 and 1e+06, not 100000000"),
        (f"{TRAIN} --slots 100000", "slots must be between 1 and 10000, not 100000"),
        (f"{TRAIN} --seed 2147483648", "seed must be between 0 and 2147483647, not 2147483648"),
        (f"{TRAIN} --workers 100000", "workers must be between 0 and 1000, not 100000"),
        (f"{TRAIN} --episode.time-limit 30000", "time_limit must be between 1 and 3600 s, not 30000.0"),
        (f"{TRAIN} --episode.time-limit nan", "time_limit must be between 1 and 3600 s, not nan"),
        (f"{TRAIN} --episode.time-limit -5", "time_limit must be between 1 and 3600 s, not -5.0"),
        (f"{TRAIN} --episode.physics.rate 1000000", "physics.rate must be between 100 and 20000 Hz, not 1000000"),
        (f"{TRAIN} --episode.physics.rate 50", "physics.rate must be between 100 and 20000 Hz, not 50"),
        (f"{TRAIN} --episode.physics.control-rate 0", "physics.control_rate must be between 50 and 1000 Hz, not 0"),
        (
            f"{TRAIN} --episode.physics.solver-iterations 1000000",
            "physics.solver_iterations must be between 1 and 10000",
        ),
        (f"{TRAIN} --episode.dimensions thigh_length 330", "must be a number between 0.033 and 3.3, not 330.0"),
        (f"{TRAIN} --episode.dimensions torso_mass 8000", "'torso_mass' must be a number between 0.8 and 80"),
        (f"{TRAIN} --episode.randomisation.friction 0.7 70", "randomisation.friction must be between 0 and 5"),
        (f"{TRAIN} --episode.randomisation.friction 1 0.5", "in rising order, not (1.0, 0.5)"),
        (f"{TRAIN} --episode.randomisation.mass-deviation 5", "randomisation.mass_deviation must be between 0 and 0.9"),
        (
            f"{TRAIN} --episode.randomisation.imu-bandwidth 0",
            "imu_bandwidth must be between 0.1 and 100000",
        ),
        (
            f"{TRAIN} --episode.randomisation.delay-ticks 5000",
            "delay_ticks must be between 0 and 100 ticks",
        ),
        (f"{TRAIN} --episode.randomisation.start-speed inf", "randomisation.start_speed must be between 0 and 10 m/s"),
        (
            f"{TRAIN} --episode.randomisation.pad-noise -1",
            "pad_noise must be between 0 and 1000 N, not -1.0",
        ),
        (f"{TRAIN} --task balance --episode.push.newtons 0 100000", "push.newtons must be between 0 and 10000 N"),
        (f"{TRAIN} --task balance --episode.push.degrees -90 90", "push.degrees must be between 0 and 720 degrees"),
        (f"{TRAIN} --task balance --episode.push.duration 150", "push.duration must be between 0 and 10 s, not 150.0"),
        (f"{TRAIN} --task balance --episode.stepping 1 1 1 1 nan", "parameter P5 must be between 0 and 2, not nan"),
        (f"{EVAL} --episodes 100000000", "episodes must be between 1 and 1e+06"),
        (f"{EVAL} --first-seed 5000000000", "first-seed must be between 0 and 4.29497e+09"),
        (f"{EVAL} --workers -2", "workers must be between 0 and 1000, not -2"),
        ("sarah-eval --parameters 1,1,1,1,inf", "parameter P5 must be between 0 and 2, not inf"),
        ("sarah-eval --parameters 1,1,-0.1,1,1", "parameter P3 must be between 0 and 2, not -0.1"),
        (f"{BALANCE_EVAL} --push-newtons inf", "push.newtons must be between 0 and 10000 N"),
        (f"{BALANCE_EVAL} --stepping 1,1,1,1,3", "parameter P5 must be between 0 and 2, not 3.0"),
        (f"{COMPARE} --seeds -1", "seeds must be between 1 and 1000, not -1"),
        (f"{COMPARE} --first-seed -1", "seed must be between 0 and 2147483647, not -1"),
        (f"{COMPARE} --episodes 0", "episodes must be between 1 and 1000, not 0"),
        (f"{COMPARE} --best-known nan", "best-known must be between 0.01 and 2, not nan"),
        (f"{COMPARE} --episodes 0", "simulations must be between 1 and 1e+06, not 0"),
        (f"{COMPARE} --episode.dimensions thigh_length 33", "must be a number between 0.033 and 3.3, not 33.0"),
        # Contradictions
        (f"{TRAIN} --episode.push.degrees 0 90", "episode.push is for task 'balance'"),
        (f"{TRAIN} --episode.dimensions thigh_mass 6", "must weigh 10 kg, not 11"),
        (f"{TRAIN} --from full", "not the folder of a finished training"),
        (f"{TRAIN} --workers 2 --scheduler tcp://127.0.0.1:9", "give one of the two"),
        (f"{TRAIN} --episode.time-limit 1.001", "time_limit must be above the 1 s of standing, not 1.001"),
        (f"{EVAL} --json --robustness x", "--robustness"),
        ("sarah-eval --task balance --parameters 1,1,1,1,1", "must be 4 numbers (V1 to V4), not 5"),
        (f"{COMPARE} --algorithms naf naf", "algorithms must be different ones"),
        (f"{COMPARE} --algorithms", "algorithms"),
        # Files and folders
        (f"{TRAIN} --config full", "cannot read full: Is a directory"),
        (f"{TRAIN} --run-dir full", "run folder full is not empty: name another with --run-dir"),
        (f"{TRAIN} --resume full", "full cannot be resumed: it has no config.yaml"),
        (f"{TRAIN} --resume nowhere", "run folder nowhere does not exist"),
        (f"{TRAIN} --resume", "--resume"),
        ("sarah-eval full/precious.txt", "run folder full/precious.txt does not exist"),
        ("sarah-compare full/precious.txt --seeds 1", "full/precious.txt"),
        ("sarah-figures full", "not the folder of a finished training"),
        ("sarah-report nowhere", "run folder nowhere does not exist"),
        ("sarah-video full out.mp4", "full"),
        ("sarah-video 1,1,1,1,1 out.txt", "out.txt"),
        ("sarah-video 1,1,1,1,1 nowhere/out.mp4", "nowhere"),
        # The page
        ("sarah-view full", "full"),
        ("sarah-view nowhere", "nowhere is neither a run folder nor numbers separated by commas"),
        ("sarah-view 1,1", "parameters must be 5 numbers (P1 to P5) or 4 numbers (V1 to V4), not 2"),
        ("sarah-view 1,1,1,1,3", "P5 must be between 0 and 2, not 3"),
        ("sarah-view --port 0", "port must be between 1 and 65535, not 0"),
        ("sarah-view --seed -1", "seed must be a whole number from 0, not -1"),
        ("sarah-view --engine mujocco", "unknown engine 'mujocco', did you mean 'mujoco'?"),
        ("sarah-view --host 203.0.113.1", "cannot serve a page at '203.0.113.1'"),
        ("sarah-view --export full", "cannot write full: it is a folder"),
        ("sarah-view --export nowhere/out.html", "cannot write nowhere/out.html: folder nowhere does not exist"),
    ],
)
def test_command_lines(line: str, message: str, answer: Callable[[str], str], tmp_path: Path) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "precious.txt").write_text("data")
    assert message in answer(line)


@NEEDS_PYBULLET
def test_transfer_of_no_training(answer: Callable[[str], str], tmp_path: Path) -> None:
    need("mujoco")
    (tmp_path / "full").mkdir()
    assert "not the folder of a finished training" in answer("sarah-transfer full")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("simulations: 10\nsimulations: 20\n", "key 'simulations' is given twice"),
        ("episode:\n  time_limit: 3\n  time_limit: 4\n", "key 'time_limit' is given twice"),
        ("episode: {push: {newton: [1, 2]}}", "did you mean 'episode.push.newtons'?"),
        ("Algo: naf", "unknown key 'Algo', did you mean 'algo'?"),
        ("1: 2", "unknown key '1'"),
        ("simulations:", "simulations must be a whole number, not None"),
        ("simulations: 1e3", "simulations must be a whole number, not '1e3'"),
        ("simulations: 2020-01-01", "simulations must be a whole number, not datetime.date"),
        ("seed: 0x7fffffffff", "seed must be between 0 and 2147483647"),
        (f"seed: {'9' * 5000}", "is not YAML"),
        (f"episode: {{time_limit: {'9' * 400}}}", "time_limit must be a number that a float can hold"),
        ("algo: [naf]", "algo must be a text, not ['naf']"),
        ("task: off", "task must be a text, not False"),
        ("episode: {reward_form: off}", "reward_form must be a text, not False"),
        ("episode: [1]", "must hold keys and values, not [1]"),
        ("episode: {dimensions: {thigh_length: 330}}", "'thigh_length' must be a number between 0.033 and 3.3"),
        ("episode: {dimensions: {tigh_length: 0.3}}", "did you mean 'thigh_length'?"),
        ("episode: {dimensions: {thigh_length: '${__import__(\"os\").getcwd()}'}}", "must be a number, not"),
        ("episode: {stepping: [1, 1, 1, 1]}", "stepping must be a list of 5 values"),
        ("episode: {stepping: [1, 1, 1, 1, .inf]}", "P5 must be between 0 and 2, not inf"),
        ("!!python/object/apply:os.system ['touch hacked']", "is not YAML"),
        ("a: &a [x, x, x, x]\nb: &b [*a, *a, *a, *a]\nepisode: [*b, *b, *b]", "unknown key 'a'"),
        ("[" * 5000, "is not YAML"),
        ("--- 1\n--- 2\n", "is not YAML"),
        ("\x00", "is not YAML"),
        ("just words", "the file must hold keys and values, not 'just words'"),
        ("task: balance\nepisode: {time_limit: 2, push: {at_seconds: [2, 3]}}", "before the time_limit of 2 s"),
    ],
)
def test_configuration_files(text: str, message: str, answer: Callable[[str], str], tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_text(text)
    line = answer("sarah-train --config mine.yaml")
    assert message in line and "mine.yaml" in line


def test_a_file_that_is_no_text(answer: Callable[[str], str], tmp_path: Path) -> None:
    (tmp_path / "mine.yaml").write_bytes(b"\xff\xfe\x00\x80")
    assert "cannot read mine.yaml" in answer("sarah-train --config mine.yaml")


@pytest.mark.parametrize(
    ("name", "content", "command", "message"),
    [
        ("parameters.json", "{", "sarah-eval", "parameters.json does not hold learned parameters"),
        ("parameters.json", "[" * 100_000, "sarah-eval", "parameters.json does not hold learned parameters"),
        ("parameters.json", json.dumps({"parameters": {**PARAMETERS, "P3": float("nan")}}), "sarah-eval", "P3"),
        ("parameters.json", json.dumps({"parameters": {**PARAMETERS, "P2": 2.5}}), "sarah-eval", "P2 must be between"),
        ("parameters.json", json.dumps({"parameters": {**PARAMETERS, "P2": "1"}}), "sarah-eval", "P2 must be between"),
        ("parameters.json", json.dumps({"parameters": PARAMETERS | {"P6": 1}}), "sarah-eval", "it names P1, P2"),
        ("parameters.json", "{}", "sarah-train --task balance --from", "does not hold learned parameters"),
        ("config.yaml", "task: stepp", "sarah-eval", "config.yaml: unknown task 'stepp', did you mean 'stepping'?"),
        ("config.yaml", "simulatons: 5", "sarah-figures", "config.yaml: unknown key 'simulatons'"),
        ("episodes.csv", EPISODE.replace("0,1,1", "0,x,1"), "sarah-figures", "cannot be read"),
        ("episodes.csv", EPISODE.replace("0,1,1", "0,nan,1"), "sarah-figures", "nan where a number must be"),
        ("episodes.csv", EPISODE + "1,1\n", "sarah-figures", "cannot be read"),
        ("episodes.csv", "", "sarah-figures", "no episodes to draw"),
        ("episodes.csv", "a,b\n\udcff\n", "sarah-figures", "cannot be read"),
        ("journal.jsonl", None, "sarah-train --resume", "cannot be resumed: it has no journal.jsonl"),
        ("config.yaml", "slots: 9", "sarah-train --slots 4 --resume", "slots is 9 in this training, not 4"),
        ("config.yaml", "slots: 4", "sarah-train --run-dir x --resume", "leave --run-dir, --config and --from out"),
        ("config.yaml", "seed: 1", "sarah-train --episode.time-limit 9 --resume", "episode.time_limit is 30.0 in this"),
    ],
)
def test_damaged_run_folders(
    name: str, content: str | None, command: str, message: str, answer: Callable[[str], str], tmp_path: Path
) -> None:
    run = RunFolder.create(tmp_path / "run", TrainingConfig())
    run.write_parameters({"parameters": PARAMETERS})
    (run.path / "episodes.csv").write_text(EPISODE)
    if content is None:
        (run.path / name).unlink()
    else:
        (run.path / name).write_bytes(content.encode(errors="surrogateescape"))
    assert message in answer(f"{command} run")


KEYS = ("task", "algo", "simulations", "seed", "slots", "episode", "physics", "rate", "friction", "stepping", "x")
SCALARS = st.none() | st.booleans() | st.integers() | st.floats() | st.text(max_size=5)
VALUES = st.recursive(
    SCALARS,
    lambda inner: st.lists(inner, max_size=5) | st.dictionaries(st.sampled_from(KEYS) | SCALARS, inner, max_size=3),
    max_leaves=8,
)
CONFIGS = st.dictionaries(st.sampled_from(KEYS), VALUES, max_size=4)


@settings(max_examples=300, deadline=None, derandomize=True)
@given(content=(VALUES | CONFIGS).map(yaml.safe_dump) | st.text(max_size=40))
def test_any_file_is_a_configuration_or_a_mistake(content: str, tmp_path_factory: pytest.TempPathFactory) -> None:
    path = tmp_path_factory.getbasetemp() / "any.yaml"
    path.write_text(content, encoding="utf-8", errors="replace")
    try:
        assert isinstance(read_config(TrainingConfig, path), TrainingConfig)
    except ConfigurationError as error:
        assert len(str(error).splitlines()) == 1 and "any.yaml" in str(error)
