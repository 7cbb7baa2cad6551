"""Files that are never half written, and files that are read within bounds, whoever wrote them.

What is replaced keeps its old content until the new one is on the disk. What is read is a regular file of a bounded
size: a FIFO would block for ever, and a file of gigabytes would fill the memory. What could not be written is refused
before the work that it is for.
"""

from __future__ import annotations

import errno
import fcntl
import io
import os
import shlex
import stat
import tempfile
import unicodedata
import uuid
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO

from sarah.errors import ConfigurationError

SMALL = 65_536
"""Largest size of a small text file, in bytes: settings, parameters, versions."""
LONGEST_LINE = 16_384
"""Largest size of a line in a table, in bytes."""
LARGEST = 2**30
"""Largest size of a file of TensorBoard's that is read, in bytes."""
UNFINISHED = ".new"
"""Ending of the name of a file that is to replace another one."""
NO_TEXT = frozenset(("Cc", "Cs", "Zl", "Zp"))
"""Unicode's categories of control characters, of bytes that are not UTF-8, and of ends of lines and paragraphs."""


def is_text(name: object) -> bool:
    """Whether a name can be written into any file and message: as one line, in UTF-8.

    :param name: name of a file or folder, or another word that a user gave
    """
    return not any(unicodedata.category(letter) in NO_TEXT for letter in str(name))


def check_name(path: Path) -> None:
    """Refuse the name of a file or folder that no settings, message or page could hold, before it is made.

    :param path: path of the file or folder
    :raises ConfigurationError: if it has control characters, or bytes that are not UTF-8
    """
    if not is_text(path):
        raise ConfigurationError(f"a name must be UTF-8 text without control characters, not {str(path)!r:.300}")


def check_file(path: Path) -> None:
    """Refuse a file that could not be written, before the work that it is for.

    :param path: path of the file, which may be there already
    :raises ConfigurationError: naming the file, and what is wrong with its name or its folder
    """
    check_name(path)
    try:
        if path.exists() and not path.is_file():  # a device would become a file
            raise ConfigurationError(f"cannot write {path}: it is {'a folder' if path.is_dir() else 'no regular file'}")
        if not path.parent.is_dir():
            raise ConfigurationError(f"cannot write {path}: folder {path.parent} does not exist")
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise ConfigurationError(f"cannot write {path}: {error.strerror or error}") from error


def make_folder(path: Path) -> None:
    """Make a folder, unless it is there, and refuse one that could not be written to, before the work that it is for.

    :param path: path of the folder
    :raises ConfigurationError: naming the folder, and what is wrong with it
    """
    check_name(path)
    try:
        path.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=path):
            pass
    except OSError as error:
        raise ConfigurationError(f"cannot write folder {path}: {error.strerror or error}") from error


def quoted(path: Path | str) -> str:
    """A path as one types it behind an option in a shell.

    :param path: path, in which a dash at the beginning would be an option
    """
    return shlex.quote(f"./{path}" if str(path).startswith("-") else str(path))


@contextmanager
def replacing(path: Path, *removed: Path) -> Iterator[BinaryIO]:
    """Write a file that replaces the old one only when it is complete.

    Of several writers at once, each writes a file of its own, and the last to end has the name.

    :param path: path of the file; if writing fails, its old content stays
    :param removed: paths of files that belong to the old content only: they go when the new one is on the disk
    """
    check_name(path)
    unfinished = path.with_name(f".{uuid.uuid4().hex}{UNFINISHED}")  # as long as it may be, whatever the other name
    try:
        with unfinished.open("xb") as file:  # "x" goes through no link
            yield file
            file.flush()
            os.fsync(file.fileno())
        for other in removed:
            other.unlink(missing_ok=True)
        os.replace(unfinished, path)
    except BaseException:
        unfinished.unlink(missing_ok=True)
        raise
    _sync_folder(path.parent)


def replace_text(path: Path, text: str, *removed: Path) -> None:
    """Replace a text file as a whole.

    :param path: path of the file
    :param text: new content; what UTF-8 lacks, such as a byte of a program's name, is escaped
    :param removed: paths of files that belong to the old content only
    """
    with replacing(path, *removed) as file:
        file.write(text.encode(errors="backslashreplace"))


def open_regular(path: Path, flags: int = os.O_RDONLY) -> BinaryIO:
    """Open a regular file, or a link to one, without ever waiting for somebody else.

    :param path: path of the file
    :param flags: flags of :func:`os.open`
    :raises OSError: if it is a FIFO, a device or a folder, or cannot be opened
    """
    descriptor = os.open(path, flags | os.O_NONBLOCK)
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise OSError(errno.EINVAL, "it is not a regular file", str(path))
        return open(descriptor, "rb" if flags & os.O_ACCMODE == os.O_RDONLY else "r+b", buffering=0)
    except BaseException:
        os.close(descriptor)
        raise


def read_text(path: Path, most_bytes: int = SMALL) -> str:
    """Read a small text file as a whole.

    :param path: path of the file
    :param most_bytes: largest size in bytes
    :raises OSError: if it is no regular file, larger, or no UTF-8 text
    """
    with io.BufferedReader(open_regular(path)) as file:  # type: ignore[type-var]  # it is a raw file
        content = file.read(most_bytes + 1)
    if len(content) > most_bytes:
        raise _too_large(path, f"more than {most_bytes:,} bytes")
    return _decoded(content, path)


def read_lines(path: Path, most_lines: int, most_bytes: int = LONGEST_LINE) -> Iterator[str]:
    """Read a text file line by line.

    :param path: path of the file
    :param most_lines: largest number of lines
    :param most_bytes: largest size of a line, in bytes
    :return: iterator over the lines, with their ends
    :raises OSError: if it is no regular file, has more or longer lines, or is no UTF-8 text
    """
    with io.BufferedReader(open_regular(path)) as file:  # type: ignore[type-var]  # it is a raw file
        for number in range(1, most_lines + 2):
            line = file.readline(most_bytes + 1)
            if not line:
                return
            if len(line) > most_bytes:
                raise _too_large(path, f"more than {most_bytes:,} bytes in line {number}")
            if number > most_lines:
                raise _too_large(path, f"more than {most_lines:,} lines")
            yield _decoded(line, path)


@contextmanager
def locked(path: Path, wait: bool = True) -> Iterator[bool]:
    """Hold a lock that one process at a time can have. It ends with its process, however that ends.

    :param path: path of the lock's file, which is made if it is missing
    :param wait: whether to wait while another process has it
    :return: context, with whether this process has the lock
    """
    file = open_locked(path, os.O_RDWR | os.O_CREAT, wait)
    try:
        yield file is not None
    finally:
        if file is not None:
            file.close()


def open_locked(path: Path, flags: int, wait: bool) -> BinaryIO | None:
    """Open a regular file, and lock it until it is closed.

    :param path: path of the file
    :param flags: flags of :func:`os.open`
    :param wait: whether to wait while another process has locked it
    :return: the file; ``None`` if another process has it
    :raises OSError: if it cannot be opened, or if its file system has no locks
    """
    file = open_regular(path, flags)
    try:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except BlockingIOError:
        file.close()
        return None
    return file


def _decoded(content: bytes, path: Path) -> str:
    try:
        return content.decode()
    except UnicodeDecodeError as error:
        raise OSError(errno.EILSEQ, "it is not UTF-8 text", str(path)) from error


def _too_large(path: Path, found: str) -> OSError:
    return OSError(errno.EFBIG, f"it has {found}", str(path))


def _sync_folder(folder: Path) -> None:
    """Write the folder's entries to the disk, so that the new name survives a power failure."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
