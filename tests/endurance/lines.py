"""Tables of code, whose cells stand between tabs as they are."""

from __future__ import annotations

import csv
from pathlib import Path


def lines_of(file: Path) -> list[dict[str, str]]:
    """Lines by column.

    :param file: the table
    """
    lines = file.read_text(encoding="utf-8").splitlines()
    return list(csv.DictReader(lines, delimiter="\t", quoting=csv.QUOTE_NONE))
