"""A log holds what it was given, whatever becomes of the disk or of the process, and holds nobody up."""

import itertools
import multiprocessing
import resource
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hand_made import rocking
from logged import NAMED, TARGETS, tick, write

from sarah.control.pattern_generator import Phase
from sarah.errors import ConfigurationError
from sarah.logs.chunk_file import ChunkFile
from sarah.logs.reading import Log
from sarah.logs.robot_log import RobotLog
from sarah.logs.summary import summarise
from sarah.logs.topic import Values
from sarah.logs.topics import PARAMETER_CHANGES, PHASE_CHANGES, TICKS, WINDOWS, reading_of
from sarah.operation.window import FELT
from sarah.robot.reading import Side


def values(path: Path, topic: str = TICKS.name) -> list[Values]:
    log = Log(path)
    return [log.values(message) for message in log.messages() if message.topic == topic]


def test_what_was_logged_is_read_to_the_bit(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap")
    ticks = values(path)
    assert [reading_of(found) for found in ticks] == [rocking(number) for number in range(100)]
    assert [ticks[9][name] for name in ("seconds", "reading_seconds", "late_seconds")] == [0.09, 0.09 - 0.001, 0.0001]
    decided = {"state": "stepping", "phase": "shift", "stance": "left", "tilt": 0.5, "rate": -0.25}
    assert decided.items() <= ticks[9].items()
    assert tuple(value for name, value in ticks[9].items() if name.startswith("target_")) == TARGETS
    (first, *_) = values(path, PHASE_CHANGES.name)
    assert first == {"seconds": 0.24, "ended": "land", "by_sensors": False, "is_step": True, "stance": "right"}
    applied, refused = values(path, PARAMETER_CHANGES.name)
    assert NAMED.items() <= applied.items() and applied["accepted"] and applied["by"] == "careful"
    assert refused["P1"] == 9.0 and refused["asked_seconds"] == 0.1 and not refused["accepted"]
    (window,) = values(path, WINDOWS.name)
    assert NAMED.items() <= window.items() and window["felt_steps_per_second"] == len(FELT) - 1
    assert [window[name] for name in ("index", "begin", "duration", "observed_reward")] == [0, 0.0, 0.99, 0.8]
    log = Log(path)
    assert [message.seconds for message in log.messages()][-1] == 0.99
    assert log.about["program"] == "a test" and log.end == {"dropped": "0"} and log.problem is None


def test_numbers_of_any_type_are_logged_and_what_is_none_is_left_out(tmp_path: Path) -> None:
    path, strange = tmp_path / "a.mcap", (np.float32(0.5), float("nan"), 9)
    with RobotLog(path, {}) as log:
        tick(log, 0, rocking(0)._replace(acceleration=strange))  # type: ignore[arg-type]
        tick(log, 1, rocking(1)._replace(acceleration=(None, 1e400, "soon")))  # type: ignore[arg-type]
        log.tick(0.02, None, 0.0, TARGETS, "stopping", Phase.LIFT, Side.LEFT, 0.0, 0.0, 0.0)
        log.tick(0.03, None, 0.0, TARGETS, "stopping", None, Side.LEFT, 0.0, 0.0, 0.0)  # type: ignore[arg-type]
        log.tick(0.04, rocking(4), 0.0, TARGETS[1:], "stepping", Phase.LIFT, Side.LEFT, 0.0, 0.0, 0.0)
        log.tick(float("nan"), None, 0.0, TARGETS, "stopping", Phase.LIFT, Side.LEFT, 0.0, 0.0, 0.0)
    first, second, last = values(path)
    assert first["acceleration_x"] == 0.5 and first["acceleration_z"] == 9.0 and "acceleration_y" not in first
    assert not {f"acceleration_{axis}" for axis in "xyz"} & set(second) and reading_of(second) is None
    assert last["tilt"] == 0.0 and "load_left_forefoot" not in last
    log.close()  # a second time
    assert log.dropped == 3 and log.failure is None  # without a phase, a target and a time


def test_no_log_is_replaced(tmp_path: Path) -> None:
    path = write(tmp_path / "a.mcap")
    before = path.read_bytes()
    with pytest.raises(ConfigurationError, match="is there already: name another file for the log"):
        RobotLog(path, {})
    assert path.read_bytes() == before


def test_a_slow_disk_costs_messages_that_are_counted_and_never_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    disk, written, add = threading.Event(), threading.Semaphore(0), ChunkFile.add

    def slow(*arguments: Any) -> None:
        disk.wait()
        add(*arguments)
        written.release()

    monkeypatch.setattr(ChunkFile, "add", slow)
    monkeypatch.setattr("sarah.logs.robot_log.MOST_WAITING", 3)
    with RobotLog(tmp_path / "a.mcap", {}) as log:
        for number in range(20):
            tick(log, number)
        dropped = log.dropped
        disk.set()
        assert all(written.acquire(timeout=10.0) for _ in range(20 - dropped))
        tick(log, 20)
    assert dropped in (16, 17)  # one message may be on its way
    summary = summarise(Log(tmp_path / "a.mcap"))
    assert summary.ticks == 21 - dropped and summary.dropped == summary.missing[TICKS.name] == dropped
    assert summary.gaps == [0.2]


def test_a_full_disk_ends_the_log_with_its_last_whole_chunk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path, limits = tmp_path / "a.mcap", resource.getrlimit(resource.RLIMIT_FSIZE)
    monkeypatch.setattr("sarah.logs.chunk_file.CHUNK_SECONDS", 0.0)
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, limits[1]))
    try:
        with RobotLog(path, {}, waits=True) as log:
            for number in range(50):
                tick(log, number)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    summary = summarise(found := Log(path), whole=True)
    assert log.failure == "File too large"
    assert 0 < summary.ticks == 50 - log.dropped and summary.missing.total() == 0
    assert found.problem == f"cut at byte {path.stat().st_size}"


def fill(path: Path) -> None:
    """Log ticks as fast as it goes."""
    with RobotLog(path, {}, waits=True) as log:
        for number in itertools.count():
            tick(log, number)


def test_a_killed_process_leaves_all_but_the_last_chunk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sarah.logs.chunk_file.CHUNK_SECONDS", 0.01)
    path = tmp_path / "a.mcap"
    process = multiprocessing.get_context("fork").Process(target=fill, args=(path,))
    process.start()
    while not path.exists() or path.stat().st_size < 50_000:
        assert process.is_alive()
    process.kill()
    process.join()
    summary = summarise(log := Log(path), whole=True)
    assert log.problem is not None and log.problem.startswith("cut at byte")
    assert summary.ticks > 100 and summary.missing.total() == 0 and summary.begin == 0.0
