"""Settings of the algorithm on the command line: set, shown, recorded and repeated."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from sarah.cli.train import main
from sarah.runs.agent_settings import NAFSettings, TD3Settings
from sarah.runs.run_folder import RunFolder
from sarah.training import train as training

SHORT = ("--episode.time-limit", "1.2", "--episode.physics.solver-iterations", "5")


@pytest.fixture
def command(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[..., None]:
    """Runs ``sarah-train`` in this process, in a folder of its own."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(training, "SUMMARY_EPISODES", 1)

    def run(*arguments: str) -> None:
        monkeypatch.setattr("sys.argv", ["sarah-train", *arguments])
        main()

    return run


@pytest.fixture
def trained(command: Callable[..., None]) -> Callable[..., RunFolder]:
    """Trains on ten short episodes."""

    def run(name: str, *arguments: str) -> RunFolder:
        command("--episodes", "10", *SHORT, "--out", name, *arguments)
        return RunFolder.open(Path(name))

    return run


def test_the_paper_s_preset_trains(trained: Callable[..., RunFolder]) -> None:
    run = trained("paper", "--agent.preset", "paper", "--agent.mu-layers", "8", "--agent.learning-rate", "1e-4")
    assert run.config().agent == NAFSettings(preset="paper", mu_layers=(8,), learning_rate=1e-4)
    content = yaml.safe_load(run.config_text())["agent"]
    assert (content["preset"], content["mu_layers"], content["l_layers"]) == ("paper", [8], [80, 80, 80, 80])
    assert content["temperature"] == 0.0 and content["learning_rate"] == 1e-4
    assert len(list(run.episodes())) == 10


def test_the_settings_of_a_run_give_the_same_training(trained: Callable[..., RunFolder]) -> None:
    run = trained("td3", "--algo", "td3", "--agent.layers", "8", "8", "--agent.learning-starts", "8")
    assert run.config().agent == TD3Settings(layers=(8, 8), learning_starts=8)
    again = trained("again", "--config", "td3/config.yaml")
    assert again.config() == run.config()
    for name in ("episodes.csv", "parameters.json"):
        assert (again.path / name).read_bytes() == (run.path / name).read_bytes()
    other = trained("other", "--config", "td3/config.yaml", "--agent.gradient-steps", "9")
    assert (other.path / "episodes.csv").read_bytes() != (run.path / "episodes.csv").read_bytes()


def test_the_command_line_changes_the_file(trained: Callable[..., RunFolder]) -> None:
    Path("mine.yaml").write_text("agent: {tau: 0.1, v_layers: [4], preset: paper, l_layers: [4]}")
    paper = {"preset": "paper", "tau": 0.1, "v_layers": (4,)}
    run = trained("same", "--config", "mine.yaml", "--agent.preset", "paper", "--agent.l-layers", "5")
    assert run.config().agent == NAFSettings(**paper, l_layers=(5,))
    run = trained("other", "--config", "mine.yaml", "--agent.preset", "one-step")
    assert run.config().agent == NAFSettings(tau=0.1)
    run = trained("td3", "--config", "mine.yaml", "--algo", "td3")
    assert run.config().agent == TD3Settings()


@pytest.mark.parametrize(
    ("arguments", "shown", "hidden"),
    [
        (("--help",), ("--agent.elite-share", "(0 to 1; default: ", "{one-step,paper}"), "--agent.layers"),
        (("--algo", "td3", "--help"), ("--agent.layers", "--agent.policy-delay"), "--agent.elite-share"),
        (("--algo=cma-es", "--help"), ("--agent.population",), "--agent.learning-rate"),
        (("--algo", "random", "--help"), ("--episode.time-limit",), "--agent."),
    ],
)
def test_the_help_shows_the_settings_of_the_algorithm(
    arguments: tuple[str, ...],
    shown: tuple[str, ...],
    hidden: str,
    command: Callable[..., None],
    capsys: pytest.CaptureFixture[str],
) -> None:
    with pytest.raises(SystemExit) as ended:
        command(*arguments)
    output = capsys.readouterr().out
    assert not ended.value.code and all(text in output for text in shown) and hidden not in output


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--agent.gamma 1.5", "agent.gamma must be between 0 and 1, not 1.5"),
        ("--agent.gamma 0.5", "agent.gamma must be 0 unless agent.temperature and agent.elite_share are 0, not 0.5"),
        ("--agent.learning-rate fast", "--agent.learning-rate must be a number, not 'fast'"),
        ("--agent.learning-rat 1e-4", "did you mean --agent.learning-rate?"),
        ("--agent.v-layers 8 x", "--agent.v-layers must be whole numbers, not ['8', 'x']"),
        ("--agent.elite-std a b", "--agent.elite-std must be one number, or two for a range, not a"),
        ("--agent.preset papr", "unknown agent.preset 'papr', did you mean 'paper'?"),
        ("--agent.device gpu", "agent.device must be 'cpu', 'cuda', 'cuda:' and a number, or 'auto', not 'gpu'"),
        ("--algo td3 --agent.preset paper", "--agent.preset is for --algo naf, not 'td3'"),
        ("--algo sac --agent.no-squash-mu", "--agent.no-squash-mu is for --algo naf, not 'sac'"),
        ("--agent.net-arch 8", "did you mean --agent.v-layers or --agent.mu-layers or --agent.l-layers?"),
        (
            "--algo td3 --agent.net_arch=8",
            "of --algo td3, did you mean --agent.layers? (allowed: --agent.learning-rate, ",
        ),
        ("--agent.layers 8", "is for --algo td3 or sac or ddpg, not 'naf', did you mean --agent.v-layers or"),
        ("--algo td3 --agent.exploration-std 0.1", "not 'td3', did you mean --agent.action-noise-std?"),
        ("--algo td3 --agent.elite-share 1", "is for --algo naf, not 'td3' (allowed: --agent.learning-rate, "),
        ("--algo td3 --agent.policy-delays 1", "did you mean --agent.policy-delay?"),
        ("--algo cma-es --agent.sigma0 1", "did you mean --agent.deviation?"),
        ("--algo tpe --agent.x 1", "unknown option --agent.x of --algo tpe (allowed: none)"),
        ("--algo random --agent.tau 1", "--agent.tau is for --algo naf or td3 or sac or ddpg, not 'random'"),
        ("--algo sac --agent.ent-coef high", "--agent.ent-coef must be FLOAT|{auto}, not ['high']"),
        ("--algo cma-es --agent.population 1", "agent.population must be between 2 and 1000, not 1"),
        ("--agent.preset", "--agent.preset"),
    ],
)
def test_mistakes_are_answered_in_one_line(
    line: str, message: str, command: Callable[..., None], capsys: pytest.CaptureFixture[Any], tmp_path: Path
) -> None:
    with pytest.raises(SystemExit) as ended:
        command(*line.split())
    (answer,) = capsys.readouterr().err.splitlines()
    assert ended.value.code == 2 and message in answer and answer.startswith("sarah-train: error: ")
    assert not list(tmp_path.iterdir())


def test_a_run_is_not_resumed_with_other_settings(
    trained: Callable[..., RunFolder], command: Callable[..., None], capsys: pytest.CaptureFixture[Any]
) -> None:
    trained("mine", "--algo", "random")
    for arguments, message in (
        (("--algo", "naf"), "algo is 'random' in this training, not 'naf': leave it out"),
        (("--task", "balance"), "task is 'stepping' in this training, not 'balance': leave it out"),
        (("--algo", "random", "--slots", "2"), "slots is 4 in this training, not 2: leave it out"),
    ):
        with pytest.raises(SystemExit):
            command("--resume", "mine", *arguments)
        assert message in capsys.readouterr().err
