"""Markdown of the reference: tables, and what docstrings and defaults say."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

from sarah.episode.tasks import Task


def table(head: list[str], rows: Iterable[list[str]]) -> Iterator[str]:
    """Lines of a Markdown table.

    :param head: its head
    :param rows: its cells
    """
    for cells in (head, ["---"] * len(head), *rows):
        yield f"| {' | '.join(cell or '-' for cell in cells)} |"
    yield ""


def markdown(text: str) -> str:
    """One line of Markdown from a docstring's reStructuredText.

    :param text: text of the docstring
    """
    text = re.sub(r":\w+(?::\w+)?:`~?([^`]+)`", r"`\1`", " ".join(text.split()))
    return text.replace("``", "`").replace("|", r"\|")


def shown(value: Any) -> str:
    """A default as the YAML file would hold it.

    :param value: the default
    """
    if isinstance(value, Task):
        return f"`{value.reference}`"
    if value in ((), {}):
        return "none"
    if isinstance(value, tuple):
        return f"`[{', '.join(map(str, value))}]`"
    return f"`{str(value).lower() if isinstance(value, bool) else value}`"
