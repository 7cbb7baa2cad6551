"""Forks a process for each command, which has already imported what most commands need: that takes them seconds.

Every line of the input names a command, its arguments, its folder, and the files for what it prints. Every line of the
output is an exit code.
"""

import contextlib
import gc
import json
import os
import runpy
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

BIN = Path(sys.executable).parent
IMPORTS = (
    *("sarah.training.train", "sarah.training.learners", "cma", "distributed", "mujoco", "tyro", "xacro", "yourdfpy"),
    *("fontTools.subset", "matplotlib.backends.backend_pdf", "matplotlib.pyplot"),
    *("torch._dynamo", "torch.utils.tensorboard"),  # what an optimiser of torch and the curves import late
)
PERHAPS = ("pybullet",)


def requested() -> dict[str, Any]:
    """The next command, in a process of its own; the parent waits for its end, and never returns."""
    answers = os.fdopen(os.dup(1), "w")
    for line in sys.stdin:
        child = os.fork()
        if not child:
            request: dict[str, Any] = json.loads(line)
            return request
        _, status = os.waitpid(child, 0)
        print(os.waitstatus_to_exitcode(status), file=answers, flush=True)
    raise SystemExit


def redirect(request: dict[str, Any]) -> None:
    """Let this process read nothing, and print into the files, or into streams that take nothing."""
    usual = [
        os.open(path, mode)
        for path, mode in [(os.devnull, os.O_RDONLY), (request["out"], os.O_WRONLY), (request["err"], os.O_WRONLY)]
    ]
    full = os.open("/dev/full", os.O_RDWR)
    (no_writer, writing), (reading, no_reader) = os.pipe(), os.pipe()
    left = [no_writer, no_reader, no_reader]
    for number in range(3):
        os.dup2({"full": full, "left": left[number]}.get(request["streams"], usual[number]), number)
    for other in (*usual, full, no_writer, writing, reading, no_reader):
        os.close(other)
    if request["streams"] == "closed":  # Python has no streams then
        for number, name in enumerate(("stdin", "stdout", "stderr")):
            os.close(number)
            setattr(sys, name, None)
            setattr(sys, f"__{name}__", None)


if __name__ == "__main__":
    sys.path[0] = str(BIN)  # as for a command
    for name in IMPORTS:
        import_module(name)
    for name in PERHAPS:
        with contextlib.suppress(ImportError):
            import_module(name)
    import_module("sarah.robot.description").describe_robot()
    gc.freeze()  # what is there stays: no process looks through it again
    wanted = requested()
    redirect(wanted)
    os.chdir(wanted["folder"])
    command = str(BIN / wanted["command"])
    sys.argv = [command, *wanted["arguments"]]
    runpy.run_path(command, run_name="__main__")
