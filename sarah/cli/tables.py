"""The tables that commands print and leave in a folder. Which older files they replace is said before the work."""

from __future__ import annotations

import sys
from pathlib import Path

from sarah.files import check_file, make_folder, replace_text


def prepare_table(path: Path) -> None:
    """Refuse a table that could not be written, and say that one of before will be replaced.

    :param path: path of the table, whose folder is made if it is missing
    :raises ConfigurationError: naming file or folder, and what is wrong with it
    """
    make_folder(path.parent)
    check_file(path)
    if path.exists():
        print(f"{path} is there already, and will be replaced", file=sys.stderr)


def leave_table(text: str, path: Path) -> None:
    """Print a table, and write it as a whole in place of the one of before.

    :param text: text of the table, and of what is around it
    :param path: path of the table
    """
    print(text)
    replace_text(path, text + "\n")
    print(path)
