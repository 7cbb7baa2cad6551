"""Commands as tests run them: in a process of their own, from another folder."""

import functools
import json
import select
import subprocess
import sys
import tempfile
from pathlib import Path

BIN = Path(sys.executable).parent
COARSE = ("--episode.physics.rate", "100", "--episode.physics.solver-iterations", "5")
"""Options of physics that takes a fifth of the time, for tests that do not look at the robot."""
SHORT = ("--episode.time-limit", "1.5", *COARSE, "--slots", "1")
"""Options of a training whose episodes are as short as can be."""
PATIENCE_SECONDS = 300


def run(command: str, *arguments: str, cwd: Path, streams: str | None = None) -> subprocess.CompletedProcess[str]:
    """Run a command in a process of its own that has its imports already, and wait for its end.

    Its standard streams may all be ``closed``, ``full``, or ``left``: pipes whose other ends nobody holds any more.
    """
    server = _warm_commands()
    assert server.stdin is not None and server.stdout is not None
    with tempfile.TemporaryDirectory() as folder:
        out, err = (Path(folder, name) for name in ("out", "err"))
        out.touch()
        err.touch()
        request = {"command": command, "arguments": arguments, "folder": str(cwd), "streams": streams}
        request |= {"out": str(out), "err": str(err)}
        print(json.dumps(request, default=str), file=server.stdin, flush=True)
        if not select.select([server.stdout], [], [], PATIENCE_SECONDS)[0]:
            server.kill()
            _warm_commands.cache_clear()
            raise subprocess.TimeoutExpired([command, *arguments], PATIENCE_SECONDS)
        code = int(server.stdout.readline())
        return subprocess.CompletedProcess([command, *arguments], code, out.read_text(), err.read_text())


@functools.cache
def _warm_commands() -> subprocess.Popen[str]:
    """The process that forks commands; it ends with this one."""
    script = Path(__file__).with_name("warm_commands.py")
    return subprocess.Popen([sys.executable, script], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)


def run_afresh(command: str, *arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    """Run a command as a user does, with all of its imports, and wait for its end."""
    return subprocess.run(
        [BIN / command, *arguments], capture_output=True, text=True, cwd=cwd, timeout=PATIENCE_SECONDS
    )


def tree(folder: Path) -> dict[str, bytes]:
    """Everything in a folder, with the content of the files."""
    return {str(path): path.read_bytes() if path.is_file() else b"" for path in sorted(folder.rglob("*"))}
