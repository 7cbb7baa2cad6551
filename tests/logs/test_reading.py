"""Whatever becomes of a log's file, what is read was written, and all else is one line."""

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from logged import TARGETS, write

from sarah.control.pattern_generator import Phase
from sarah.errors import ConfigurationError
from sarah.logs.export import cut
from sarah.logs.reading import MAGIC, Log
from sarah.logs.summary import summarise
from sarah.logs.topics import TICKS
from sarah.robot.reading import Side

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
