"""A log holds what it was given, whatever becomes of disk, process and file, and all else is one line."""

import itertools
import multiprocessing
import resource
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hand_made import rocking
from hypothesis import given, settings
from hypothesis import strategies as st
from logged import NAMED, TARGETS, tick, write

from sarah.control.pattern_generator import Phase
from sarah.errors import ConfigurationError
from sarah.logs.chunk_file import ChunkFile
from sarah.logs.export import cut
from sarah.logs.reading import MAGIC, Log
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


def test_numbers_of_any_type_are_logged_and_no_others(tmp_path: Path) -> None:
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


def test_a_slow_disk_costs_counted_messages_and_never_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
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


Damage = tuple[str, float, bytes]


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("logs") / "whole.mcap", ticks=25)


def damaged(content: bytes, how: str, share: float, new: bytes) -> bytes:
    """A file that was cut, changed or shifted at some place."""
    place = int(share * len(content))
    behind = {"cut": b"", "change": new + content[place + len(new) :], "insert": new + content[place:]}
    return content[:place] + behind[how]


@settings(max_examples=60)
@given(st.lists(st.tuples(st.sampled_from(("cut", "change", "insert")), st.floats(0.0, 0.999), st.binary(min_size=1))))
def test_a_damaged_log_has_no_message_that_was_not_written(whole: Path, damages: list[Damage]) -> None:
    content, path = whole.read_bytes(), whole.with_name("damaged.mcap")
    for how, share, new in damages:
        content = damaged(content, how, share, new)
    path.write_bytes(content)
    written = list(Log(whole).messages())
    try:
        summarise(Log(path), whole=True)
        read = list(Log(path).messages())
        assert read == [message for message in written if message in read]
    except ConfigurationError as error:
        assert str(path) in str(error) and "\n" not in str(error) and len(str(error)) < 1000


def test_a_log_cut_anywhere_is_read_to_its_last_whole_chunk(whole: Path) -> None:
    content, path = whole.read_bytes(), whole.with_name("cut.mcap")
    counts = []
    for size in range(len(MAGIC), len(content), 211):
        path.write_bytes(content[:size])
        summary = summarise(log := Log(path))
        assert log.problem is not None and log.problem.startswith("cut at byte") and summary.missing.total() == 0
        counts.append(summary.ticks)
    assert counts == sorted(counts) and set(counts) == set(range(26))


def test_a_summary_counts_what_was_logged_and_a_part_has_no_gap(whole: Path) -> None:
    summary = summarise(Log(whole))
    assert (summary.ticks, summary.begin, summary.end, summary.seconds) == (25, 0.0, 0.24, 0.24)
    assert (summary.late, summary.worst, summary.dropped, summary.steps) == (1, 0.003, 0, 1)
    assert summary.ended == {"land": 1} and summary.by_sensors["land"] == 0
    assert summary.steps_per_second == 1 / 0.24 and summary.observed_reward == 0.8
    part = whole.with_name("part.mcap")
    assert cut(Log(whole), 0.1, 0.2, part) == 11
    summary = summarise(Log(part))
    assert (summary.ticks, summary.begin, summary.late, summary.missing.total()) == (11, 0.1, 0, 0)
    assert summary.stepping_seconds == pytest.approx(0.1) and summary.observed_reward is None


@pytest.mark.parametrize("data", [b"", b"\xff", b"[]", b"1", b"{}", b"[" * 100_000])
def test_what_is_no_message_is_refused_in_one_line(data: bytes) -> None:
    with pytest.raises(ConfigurationError, match="a message of /ticks "):
        TICKS.decoded(data)


def other(path: Path, topic: str, schema: str, data: bytes = b"{}") -> Path:
    """An MCAP file that another program wrote."""
    from mcap.writer import Writer

    with path.open("wb") as file:
        writer = Writer(file)
        writer.start()
        channel = writer.register_channel(topic, "json", writer.register_schema(schema, "jsonschema", b"{}"))
        writer.add_message(channel, 0, data, 0)
        writer.finish()
    return path


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("/imu", "Imu"), "is not a log of sarah: its topics are /imu"),
        (("/ticks", "Tick"), "is not a log of sarah: /ticks has the schema Tick, not sarah.Tick"),
        (("/ticks", "sarah.Tick"), "a message of /ticks has no seconds"),
        (("/ticks", "sarah.Tick", b'{"seconds":"0"}'), "a message of /ticks has no state"),
    ],
)
def test_another_programs_file_is_refused(tmp_path: Path, arguments: tuple[str, ...], words: str) -> None:
    path = other(tmp_path / "other.mcap", *arguments)  # type: ignore[arg-type]  # the last one is of bytes
    with pytest.raises(ConfigurationError, match=f"{path}:? {words}"):
        summarise(Log(path))


def test_a_value_of_another_type_is_named() -> None:
    message = TICKS.encoded(0.0, None, 0.0, TARGETS, "stepping", Phase.LIFT, Side.LEFT, 0.0, 0.0, 0.0)
    for wrong in (b'"0"', b"true", b"1e999", b"NaN", b"null"):
        with pytest.raises(ConfigurationError, match="tilt of /ticks must be a number, not"):
            TICKS.decoded(message.replace(b'"tilt":0.0', b'"tilt":' + wrong))
