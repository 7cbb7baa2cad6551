"""Dask's workers on this machine: they stay and answer whatever surrounds them, or one line says why they cannot."""

import itertools
import os
import resource
import shutil
import signal
import socket
import sys
import threading
import time
from pathlib import Path
from typing import Any

import dask
import distributed
import psutil
import pytest

from sarah import EpisodeConfig, EpisodeSpec, simulate
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode import cluster as cluster_module
from sarah.episode.workers import Workers
from sarah.errors import DescriptionError, WorkersError
from sarah.robot.description import describe_robot


def test_workers_that_cannot_start_say_why(capfd: pytest.CaptureFixture[str]) -> None:
    before, cause = dict(os.environ), "ModuleNotFoundError: No module named 'not_there'"
    with (
        dask.config.set({"distributed.worker.preload": ["not_there"]}),
        pytest.raises(WorkersError, match=f"^no workers can start .*: {cause}"),
    ):
        Workers(1).__enter__()
    assert dict(os.environ) == before and capfd.readouterr().err == ""


FAILED = (RuntimeError("it failed"), AssertionError("init"), ValueError("a\n 'b'"), KeyError("b")), "ValueError: a 'b'"
DAEMON = (RuntimeError("it failed"), AttributeError("init"), AssertionError("daemon")), "AssertionError: daemon"


@pytest.mark.parametrize(("errors", "words"), [FAILED, DAEMON])
def test_the_first_cause_is_said_and_not_its_aftermath(errors: Any, words: str, monkeypatch: Any) -> None:
    def fail(**_: object) -> None:
        for error, context in itertools.pairwise(errors):
            error.__context__ = context
        raise errors[0] from errors[1]

    monkeypatch.setattr(distributed, "LocalCluster", fail)
    with pytest.raises(WorkersError, match=f"^no workers can start on this machine: {words}$"):
        Workers(1).__enter__()


def test_workers_that_cannot_start_again_are_not_waited_for(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    environment, scratch = dict(os.environ), tmp_path / "scratch"
    monkeypatch.setattr(cluster_module, "WATCH_SECONDS", 0.5)
    words = "all worker processes of this machine have ended, and no other could start"
    with dask.config.set({"temporary-directory": str(scratch)}), Workers(1) as workers:
        shutil.rmtree(scratch)
        scratch.touch()
        with pytest.raises(WorkersError, match=words):
            workers.submit(os._exit, 1).result()
    assert dict(os.environ) == environment


def die_twice(folder: str) -> str:
    attempts = Path(folder) / "attempts"
    with attempts.open("a") as file:
        file.write("x")
    if attempts.stat().st_size <= 2:
        os._exit(1)
    return attempts.read_text()


def test_what_a_scheduler_gives_up_is_handed_in_again(workers: Workers, tmp_path: Path) -> None:
    assert workers.submit(die_twice, str(tmp_path)).result() == "xxx"


def test_somebodys_settings_do_not_let_workers_go(workers: Workers) -> None:
    client = workers.client
    assert client is not None
    assert set(client.run(lambda dask_worker: dask_worker.lifetime).values()) == {None}
    for limit in ("idle_timeout", "no_workers_timeout"):
        assert client.run_on_scheduler(lambda name, dask_scheduler: getattr(dask_scheduler, name), limit) is None


def print_much() -> None:
    for _ in range(100):
        print("much", flush=True)


def test_every_call_is_answered(workers: Workers, monkeypatch: pytest.MonkeyPatch) -> None:
    """Those of workers whose output nobody reads, those that end while somebody looks, and those that fail."""
    workers.submit(print_much).result()
    monkeypatch.setattr(cluster_module, "WATCH_SECONDS", 0.001)
    assert [workers.submit(abs, -number).result() for number in range(100)] == list(range(100))
    with pytest.raises(DescriptionError, match="unknown robot dimension 'legs'"):
        workers.submit(describe_robot, {"legs": 3.0}).result()


def test_workers_ignore_an_interrupt_and_answer_in_order(workers: Workers) -> None:
    assert workers.client is not None
    pids = workers.client.run(os.getpid)
    for pid in pids.values():
        os.kill(pid, signal.SIGINT)
    specs = [EpisodeSpec(PAPER_STEPPING, seed, config=EpisodeConfig(time_limit=1.5)) for seed in range(6)]
    assert list(workers.simulate_all(specs)) == [simulate(spec) for spec in specs]
    assert workers.client.run(os.getpid) == pids


def test_an_interrupt_waits_until_workers_have_started(capfd: pytest.CaptureFixture[str]) -> None:
    def interrupt_all() -> None:
        while not (children := psutil.Process().children(recursive=True)):
            time.sleep(0.01)
        time.sleep(0.5)
        for process in (*children, *psutil.Process().children(recursive=True), psutil.Process()):
            process.send_signal(signal.SIGINT)

    before = signal.signal(signal.SIGINT, signal.default_int_handler)  # it may have been switched off for all tests
    try:
        with pytest.raises(KeyboardInterrupt):
            threading.Thread(target=interrupt_all).start()
            with Workers(1):
                pytest.fail("the interrupt did not come")
    finally:
        signal.signal(signal.SIGINT, before)
    assert capfd.readouterr().err == ""


def test_workers_listen_to_this_machine_only(workers: Workers) -> None:
    here = psutil.Process()
    listening = [
        connection.laddr.ip
        for process in (here, *here.children(recursive=True))
        for connection in process.net_connections()
        if connection.status == psutil.CONN_LISTEN
    ]
    assert listening and set(listening) == {"127.0.0.1"}


def pages_taken(megabytes: int) -> int:
    """Pages that a process takes from the system while it makes and forgets arrays of a megabyte."""
    bytearray(2**20)
    before = resource.getrusage(resource.RUSAGE_SELF).ru_minflt
    for _ in range(megabytes):
        bytearray(2**20)
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt - before


@pytest.mark.skipif(sys.platform != "linux", reason="counts what Linux gives to a process")
def test_workers_keep_the_memory_that_they_use_again(workers: Workers) -> None:
    assert workers.submit(pages_taken, 100).result() < 1000  # and not the 256 of each megabyte


def test_a_scheduler_that_does_not_answer_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(cluster_module, "SCHEDULER_SECONDS", 1)
    with pytest.raises(WorkersError, match=r"no Dask scheduler answers at 'tcp://127.0.0.1:9'"):
        Workers(scheduler="tcp://127.0.0.1:9").__enter__()
    with socket.create_server(("127.0.0.1", 0)) as server:
        address = f"tcp://127.0.0.1:{server.getsockname()[1]}"
        with pytest.raises(WorkersError, match=f"{address}': the port is open, but silent"):
            Workers(scheduler=address).__enter__()
