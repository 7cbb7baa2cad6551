"""What a new kind of recorded work has of its own is its settings, requests and outcomes; the rest comes with it."""

import errno
import hashlib
import json
import re
import subprocess
import sys
import time
from dataclasses import asdict
from pathlib import Path

import pytest
import throws
from throws import THROWS, Game, play

from sarah.errors import ResumeError, RunFolderError
from sarah.recorded import folder
from sarah.recorded.folder import Folder
from sarah.versions import versions

GAME = Game(3, 40)


def begun(path: Path) -> Path:
    def write_game() -> None:
        (path / "game.json").write_text(json.dumps(asdict(GAME)))

    Folder(path, THROWS).begin(write_game)
    return path


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return begun(tmp_path / "game")


def test_killed_in_the_middle_it_goes_on_to_the_same_bytes(tmp_path: Path) -> None:
    play(begun(tmp_path / "whole"), GAME)
    journal = tmp_path / "killed/journal.jsonl"
    process = subprocess.Popen([sys.executable, throws.__file__, str(journal.parent)])
    while process.poll() is None and not (journal.exists() and journal.read_bytes().count(b"\n") > 5):
        time.sleep(0.01)
    process.kill()
    assert process.wait() == -9 and 5 < journal.read_bytes().count(b"\n") < 41
    play(journal.parent, GAME)
    for name in ("journal.jsonl", "parameters.json", "game.json", "versions.txt"):
        assert (journal.parent / name).read_bytes() == (tmp_path / "whole" / name).read_bytes(), name


@pytest.mark.parametrize("line", [b"", b"\n", b"rubbish\n", b"0000000 {}\n", b"\xff\x00\n", b"ffffffff []\n"])
def test_what_is_known_is_not_asked_again_whatever_is_between(line: bytes, path: Path) -> None:
    best = play(path, GAME)
    first, *rows = (path / "journal.jsonl").read_bytes().splitlines(keepends=True)
    (path / "journal.jsonl").write_bytes(b"".join([first, line, *rows]))
    began = time.monotonic()
    assert play(path, GAME, seconds=10.0) == best and time.monotonic() - began < 5.0
    assert (path / "journal.jsonl").read_bytes().count(b"\n") == 41 + bool(line)  # nothing was added


def refused(path: Path, game: Game, words: str) -> None:
    """Check that a game does not go on, and is left as it is."""
    before = {file: file.read_bytes() for file in path.iterdir()}
    with pytest.raises(ResumeError, match=words) as found:
        play(path, game)
    assert str(found.value).isprintable() and before == {file: file.read_bytes() for file in path.iterdir()}


def test_edited_settings_are_refused(path: Path) -> None:
    play(path, GAME)
    both = "seed is 4 here, and 3 in this game; throws is 10 here, and 40 in this game"
    refused(path, Game(4, 10), rf"{both}: put that back, or begin anew \(.*game.json has the settings\)$")


@pytest.mark.parametrize("name", ["python", "sarah-sources", "torch"])
def test_other_versions_are_refused(name: str, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with monkeypatch.context() as other:
        other.setattr(folder, "versions", lambda: {**versions(), name: "0.0.7"})
        play(path, GAME)
    here = re.escape(versions()[name])
    refused(path, GAME, rf"game cannot be resumed: {name} is {here} here, and 0\.0\.7 in this game")


def test_without_the_first_row_nothing_goes_on(path: Path) -> None:
    play(path, GAME)
    first, *rows = (path / "journal.jsonl").read_bytes().splitlines(keepends=True)
    for damaged in (first.replace(b'"seed":3', b'"seed":4'), b"", b"x" * 200_000 + b"\n"):
        (path / "journal.jsonl").write_bytes(b"".join([damaged, *rows]))
        refused(path, GAME, r"the first row of journal.jsonl, .* is damaged or missing")


def test_rows_of_another_training_do_not_count(tmp_path: Path) -> None:
    for seed in (3, 4):
        play(begun(tmp_path / str(seed)), Game(seed, 40))
    path, other = (tmp_path / str(seed) / "journal.jsonl" for seed in (3, 4))
    first, _ = path.read_bytes().split(b"\n", 1)
    path.write_bytes(first + b"\n" + other.read_bytes().split(b"\n", 1)[1])
    with Folder(path.parent, THROWS).journal(asdict(GAME), 40) as journal:
        assert not journal.replaying


def test_what_others_wrote_is_printed_without_control_characters(path: Path) -> None:
    origin = json.dumps({"torch": "\x1b[31m" * 3000, "\x1b[2J": 1}).encode()
    (path / "journal.jsonl").write_bytes(hashlib.sha256(origin).hexdigest()[:16].encode() + b" " + origin + b"\n")
    refused(path, GAME, "not known")


def test_a_journal_larger_than_any_such_game_is_not_read(path: Path) -> None:
    play(path, GAME)
    with (path / "journal.jsonl").open("ab") as file:
        file.truncate(400_001)
    with pytest.raises(ResumeError, match=r"journal.jsonl has 400001 bytes, but such a game writes at most 400000"):
        play(path, GAME)


def test_a_beginning_that_was_cut_is_no_obstacle(tmp_path: Path) -> None:
    path = tmp_path / "game"

    def cut() -> None:
        (path / ".0.new").touch()  # what a kill leaves of a file that is being replaced
        with pytest.raises(RunFolderError, match=r"not empty: name another with --out$"):
            begun(path)  # as long as the other is at it
        raise OSError(errno.ENOSPC, "No space left on device")

    for _ in range(2):
        with pytest.raises(RunFolderError, match=r"cannot write folder .*/game: No space left on device"):
            Folder(path, THROWS).begin(cut)
    play(begun(path), GAME)


def test_a_result_whose_outcomes_are_lost_is_left_alone(path: Path) -> None:
    play(path, GAME)
    (path / "journal.jsonl").write_bytes(b"")
    with pytest.raises(ResumeError, match=r"it has a result, but journal\.jsonl is empty"):
        play(path, GAME)
    assert not (path / "journal.jsonl").stat().st_size


@pytest.mark.parametrize("other", ["notes.txt", "config.yaml", "journal.jsonl"])
def test_what_somebody_else_has_in_a_folder_is_left_alone(other: str, tmp_path: Path) -> None:
    (tmp_path / "journal.jsonl").touch()
    (tmp_path / other).write_text("theirs")
    with pytest.raises(RunFolderError, match=r"not empty: name another with --out$"):
        begun(tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted({"journal.jsonl", other})
    assert (tmp_path / other).read_text() == "theirs"


def test_its_folder_belongs_to_one(path: Path) -> None:
    with pytest.raises(RunFolderError, match=r"not empty: name another .*, or go on with python throws.py --resume"):
        begun(path)
    with Folder(path, THROWS).journal(asdict(GAME), 40), pytest.raises(ResumeError, match="another game"):
        play(path, GAME)
    assert Folder(path, THROWS).versions() == versions() and (path / "command.txt").is_file()
    with pytest.raises(RunFolderError, match=r"not the folder of a finished game: it has no parameters.json"):
        Folder(path, THROWS).check(finished=True)
