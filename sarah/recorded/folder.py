"""The folder of something that is recorded: its specification, the command, the versions, and the journal."""

from __future__ import annotations

import itertools
import shlex
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from sarah.errors import ResumeError, RunFolderError
from sarah.files import UNFINISHED, check_name, locked, quoted, read_text, replace_text
from sarah.recorded.journal import Journal
from sarah.recorded.kind import Kind
from sarah.versions import differences, versions

LONGEST_REASON = 200
"""Length up to which a message quotes the error of a file or a row, in characters."""
EVENTS = "events.out.tfevents."
"""Prefix of the names of TensorBoard's files."""


class Folder:
    """The folder of something that is recorded, with the files that all kinds have in common.

    :param path: path of the folder
    :param kind: kind of what is recorded
    """

    def __init__(self, path: Path, kind: Kind) -> None:
        self.path = path
        self.kind = kind
        self.specification_path = path / kind.specification
        self.journal_path = path / "journal.jsonl"
        self.result_path = path / "parameters.json"
        self._command_path = path / "command.txt"
        self._versions_path = path / "versions.txt"

    @property
    def is_finished(self) -> bool:
        """Whether it has come to its end, with a result."""
        return self.result_path.is_file()

    def check_new(self) -> None:
        """Refuse a folder that has something in it, before work that only a new one makes worthwhile.

        :raises RunFolderError: if the folder is not empty
        """
        if self.path.is_dir():
            self._check_new()

    def begin(self, write_specification: Callable[[], None]) -> None:
        """Make a new folder, and write the command, the versions, and what is to be done.

        :param write_specification: function that writes the specification, and before it what it needs: a folder that
            has it can be resumed
        :raises RunFolderError: if the folder is not empty, or cannot be written; what is left then is no obstacle
        """
        check_name(self.path)
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._check_new()
            with locked(self.journal_path, wait=False) as is_ours:  # of two processes at once, one has the folder
                self._check_new(is_ours)
                replace_text(self._command_path, f"{shlex.join(sys.argv)}\n")
                self._write_versions()
                write_specification()
        except RunFolderError:
            raise
        except OSError as error:
            raise RunFolderError(f"cannot write {self.kind.folder} {self.path}: {error.strerror or error}") from error

    def _check_new(self, is_ours: bool = True) -> None:
        """Refuse a folder with more than what is there if a process is stopped before the specification is."""
        found = {path for path in self.path.iterdir() if path.suffix != UNFINISHED}
        is_empty = self.journal_path not in found or not self.journal_path.stat().st_size
        if is_ours and is_empty and found <= {self.journal_path, self._command_path, self._versions_path}:
            return
        can_go_on = self.specification_path.is_file() and self.journal_path.is_file() and not self.is_finished
        go_on = f", or {self.go_on}" if can_go_on else ""
        raise RunFolderError(f"{self.kind.folder} {self.path} is not empty: name another with --out{go_on}")

    @property
    def go_on(self) -> str:
        """Words for how to go on with it."""
        return f"go on with {self.kind.command} --resume {quoted(self.path)}"

    def check(self, finished: bool = False) -> None:
        """Refuse what is not the folder of something of this kind.

        :param finished: whether it must have come to its end
        :raises RunFolderError: naming what is missing
        """
        if not self.path.is_dir():
            is_what = "is a file, not a folder" if self.path.exists() else "does not exist"
            raise RunFolderError(f"{self.kind.folder} {self.path} {is_what}")
        kind = f"finished {self.kind.name}" if finished else self.kind.name
        for file in (self.specification_path, self.result_path) if finished else (self.specification_path,):
            if not file.is_file():
                inside = next(iter(sorted(self.path.glob(f"*/{file.name}"))), None)
                hint = f", and {inside.parent} has one" if inside else ""
                raise RunFolderError(f"{self.path} is not the folder of a {kind}: it has no {file.name}{hint}")

    @contextmanager
    def journal(self, settings: Mapping[str, Any], most_requests: int) -> Iterator[Journal]:
        """The journal, as a context in which no other process can use it.

        :param settings: settings by name, as JSON has them, without those that change no outcome
        :param most_requests: number of requests that such a program has at most
        :raises ResumeError: if it was begun with other settings, code or versions, is in use, or has lost its outcomes
        """
        if self.is_finished and self.journal_path.is_file() and not self.journal_path.stat().st_size:
            raise ResumeError(f"{self.path} cannot be resumed: it has a result, but {self.journal_path.name} is empty")
        origin = {**settings, **versions()}
        with Journal(self.journal_path, origin, self.kind, most_requests) as journal:
            if journal.is_new:
                self._write_versions()  # they may not be those that the folder was made with
            yield journal

    def check_versions(self) -> None:
        """Refuse what was begun with other code or versions.

        :raises ResumeError: naming what differs, here and there
        """
        if different := differences(versions(), self.versions(), f"in this {self.kind.name}"):
            raise ResumeError(f"{self.path} cannot be resumed: {different}")

    def versions(self) -> dict[str, str]:
        """Read the versions with which it began, by name of the package.

        :raises RunFolderError: if they cannot be read
        """
        try:
            lines = read_text(self._versions_path).splitlines()
        except OSError as error:
            raise unreadable(self._versions_path, error) from error
        return {name: version for name, _, version in (line.partition(" ") for line in lines)}

    def _write_versions(self) -> None:
        lines = (f"{name} {version}\n" for name, version in versions().items())
        replace_text(self._versions_path, "".join(lines))

    def event_files(self) -> list[Path]:
        """Paths of TensorBoard's files, whatever they are: a FIFO of that name would block who opens it."""
        return sorted(self.path.glob(f"{EVENTS}*"))


def new_path(group: str, name: str) -> Path:
    """Make an empty folder ``runs/<group>/<name>``, with a number behind it if that one exists.

    Whoever makes the folder has it, so that no other process takes it at the same time.

    :param group: name of the task, or of another group
    :param name: name within the group
    :raises RunFolderError: if it cannot be made
    """
    path = base = Path("runs") / group / name
    try:
        base.parent.mkdir(parents=True, exist_ok=True)
        for number in itertools.count(2):
            try:
                path.mkdir()
                break
            except FileExistsError:
                path = base.with_name(f"{base.name}-{number}")
    except OSError as error:
        raise RunFolderError(f"cannot write run folder {path}: {error.strerror or error}") from error
    return path


def unreadable(path: Path, error: Exception) -> RunFolderError:
    """Error that names a file, and says in short why it cannot be read.

    :param path: path of the file
    :param error: what reading it raised
    """
    reason = getattr(error, "strerror", None) or repr(error)
    return RunFolderError(f"{path} cannot be read: {reason[:LONGEST_REASON]}")
