"""What the commands say of themselves."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from terminal import run_afresh

from sarah.cli import operate
from sarah.runs.agent_settings import AGENT_SETTINGS


@pytest.mark.parametrize(
    ("command", "options"),
    [
        (
            "sarah-train",
            ("--task", "--algo", "--episodes", "--seed", "--out", "--config", "--workers", "--scheduler"),
        ),
        ("sarah-figures", ("RUN", "--out")),
        (
            "sarah-view",
            (
                "RUN|NUMBERS|NAME",
                "--which",
                "--seed",
                "--episode.push.newtons",
                "--out",
                "--host",
                "--port",
                "no password",
            ),
        ),
        (
            "sarah-video",
            ("RUN|NUMBERS|NAME", "--out FILE", "--which", "--episode.push.newtons", "--seconds", "--speed"),
        ),
        ("sarah-compare", ("--out DIR", "--algorithms", "--seeds", "--episodes", "--best-known", "--workers")),
        ("sarah-eval", ("RUN|NUMBERS|NAME", "--episodes", "--first-seed", "--json", "--episode.engine", "--task")),
    ],
)
def test_help_names_the_options(command: str, options: tuple[str, ...], tmp_path: Path) -> None:
    process = run_afresh(command, "--help", cwd=tmp_path)
    assert process.returncode == 0
    text = " ".join(process.stdout.replace("│", " ").split())
    assert [option for option in options if option not in text] == []


@pytest.mark.parametrize(("command", "option"), [("train", "--algo STR"), ("compare", "--algorithms [STR")])
def test_help_lists_every_algorithm_of_the_table(command: str, option: str) -> None:
    """Also one that is new in the table of settings."""
    program = (
        "import sys\nfrom sarah.runs import agent_settings\n"
        "agent_settings.AGENT_SETTINGS['ninth'] = agent_settings.AgentSettings\n"
        f"from sarah.cli.{command} import main\nsys.argv = ['command', '--help']\nmain()"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    text = " ".join(process.stdout.replace("│", " ").replace("``", "").split())
    described = text.partition(option)[2].partition("(default:")[0]
    assert [algo for algo in (*AGENT_SETTINGS, "ninth") if algo not in described] == []


@pytest.mark.parametrize("command", ["train", "eval", "figures", "compare", "describe", "transfer", "video", "view"])
def test_help_loads_nothing_slow(command: str) -> None:
    program = (
        f"import sys\nfrom sarah.cli.{command} import main\nsys.argv = ['command', '--help']\n"
        "try:\n    main()\nexcept SystemExit:\n    pass\n"
        "slow = {'torch', 'viser', 'matplotlib', 'pybullet', 'stable_baselines3', 'yourdfpy'}\n"
        "slow |= {'yaml', 'mujoco'}\n"
        "sys.exit(' '.join(slow & set(sys.modules)) or 0)"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert process.stderr == "" and process.returncode == 0


def test_help_lists_no_option_that_is_refused(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("sys.argv", ["sarah-operate", "--help"])
    with pytest.raises(SystemExit):
        operate.main()
    listed = set(re.findall(r"--episode[\w.-]+", capsys.readouterr().out))
    assert {"--episode.push.newtons", "--episode.payload"} <= listed
    assert listed.isdisjoint(operate.WITHOUT_EFFECT)
