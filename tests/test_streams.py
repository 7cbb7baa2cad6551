"""Standard streams that nobody reads, as a program has them that keeps them."""

import os
import subprocess
import sys

import pytest


def kept(program: str, shell: str, **environment: str) -> subprocess.CompletedProcess[bytes]:
    """Run a program that keeps its streams, in a command line of the shell, where it is ``"$@"``."""
    program = f"import os, sys\nfrom sarah.streams import *\nkeep_streams()\n{program}"
    command = ["bash", "-c", shell, "bash", sys.executable, "-c", program]
    return subprocess.run(command, capture_output=True, env={**os.environ, **environment}, timeout=60)


def test_a_closed_stream_gets_no_file() -> None:
    """Otherwise the first file that is opened would receive everything that is printed."""
    program = """
numbers = [os.open("/dev/zero", os.O_RDONLY)]
print("text")
print("text", file=sys.stderr)
os.system("echo text; echo text >&2")  # another program has them too
sys.exit(numbers[0] < 3 or sys.stdin.read() != "")
"""
    assert kept(program, '"$@" <&- >&- 2>&-').returncode == 0
    only = kept(program, '"$@" 2>&-')
    assert (only.returncode, only.stdout, only.stderr) == (0, b"text\ntext\n", b"")


@pytest.mark.parametrize("unbuffered", ["", "1"])
def test_what_cannot_be_written_goes_nowhere(unbuffered: str) -> None:
    program = """
print("text", flush=True)
print("text", file=sys.stderr)
os.write(1, b"of other code")
os.write(2, b"of other code")
"""
    shell = '"$@" > /dev/full 2>&1 && ("$@" 2>&1; echo $? >&3) 3>&2 | true'
    assert kept(program, shell, PYTHONUNBUFFERED=unbuffered).stderr == b"0\n"


def test_a_reader_in_no_hurry_gets_everything() -> None:
    """Also if somebody else has made the pipe non-blocking, as many programs do that share one."""
    program = "os.set_blocking(1, False); print('0123456789' * 100_000); check_output()"
    process = kept(program, '"$@" | (sleep 0.3; cat)')
    assert (process.stdout, process.stderr) == (b"0123456789" * 100_000 + b"\n", b"")


WRITTEN = {"ascii": rb"\xfc \u221e ", "latin-1": b"\xfc " + rb"\u221e ", "utf-8": "ü ∞ ".encode()}


@pytest.mark.parametrize(("encoding", "written"), WRITTEN.items())
def test_any_letter_and_any_name_can_be_written(encoding: str, written: bytes) -> None:
    program = r"print('ü ∞ \udce9'); print('ü ∞ \udce9', file=sys.stderr)"
    process = kept(program, '"$@"', PYTHONIOENCODING=encoding)
    assert process.stdout == process.stderr == written + rb"\udce9" + b"\n"


def test_other_streams_than_the_process_has_are_left_alone(capsys: pytest.CaptureFixture[str]) -> None:
    from sarah.streams import keep_streams

    before = sys.stdout, sys.stderr
    keep_streams()
    assert (sys.stdout, sys.stderr) == before
