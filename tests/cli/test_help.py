"""What the commands say of themselves."""

import subprocess
import sys
from pathlib import Path

import pytest
from terminal import run

COMMANDS = ("train", "operate", "eval", "view", "video", "transfer", "report", "compare", "figures", "describe")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_writes_to_out(command: str, tmp_path: Path) -> None:
    process = run(f"sarah-{command}", "--help", cwd=tmp_path)
    assert process.returncode == 0
    assert "--out DIR" in process.stdout or "--out FILE" in process.stdout
    assert "--run-dir" not in process.stdout and "--export" not in process.stdout


def test_help_lists_every_algorithm_of_the_table_and_loads_nothing_slow() -> None:
    program = (
        "import contextlib, sys\nfrom importlib import import_module\nfrom sarah.runs import agent_settings\n"
        "agent_settings.AGENT_SETTINGS['ninth'] = agent_settings.AgentSettings\n"
        f"for command in {COMMANDS}:\n    print('command', command)\n    sys.argv = ['command', '--help']\n"
        "    with contextlib.suppress(SystemExit):\n        import_module(f'sarah.cli.{command}').main()\n"
        "slow = {'torch', 'viser', 'matplotlib', 'pybullet', 'mujoco', 'stable_baselines3', 'yourdfpy', 'yaml'}\n"
        "sys.exit(' '.join(slow & set(sys.modules)) or 0)"
    )
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert process.stderr == "" and process.returncode == 0
    text = " ".join(process.stdout.replace("│", " ").replace("``", "").split())
    for command, option in (("train", "--algo STR"), ("compare", "--algorithms [STR")):
        described = text.partition(f"command {command}")[2].partition(option)[2].partition("(default:")[0]
        assert [name for name in ("naf", "cma-es", "ninth") if name not in described] == []
