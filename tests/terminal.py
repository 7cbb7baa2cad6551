"""Commands as tests run them: in a process of their own, from another folder."""

import subprocess
import sys
from pathlib import Path

BIN = Path(sys.executable).parent
SHORT = ("--episode.time-limit", "1.5", "--slots", "1")
"""Options of a training whose episodes are as short as can be."""


def run(command: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a command and wait for its end."""
    return subprocess.run([BIN / command, *arguments], capture_output=True, text=True, cwd=cwd, timeout=300)


def tree(folder: Path) -> dict[str, bytes]:
    """Everything in a folder, with the content of the files."""
    return {str(path): path.read_bytes() if path.is_file() else b"" for path in sorted(folder.rglob("*"))}
