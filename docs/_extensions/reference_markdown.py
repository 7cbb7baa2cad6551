"""Markdown of the reference: tables, and what docstrings and defaults say."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import Any

import docstring_parser

from sarah.episode.tasks import Task


def table(head: list[str], rows: Iterable[list[str]]) -> Iterator[str]:
    """Lines of a Markdown table.

    :param head: its head
    :param rows: its cells
    """
    for cells in (head, ["---"] * len(head), *rows):
        yield f"| {' | '.join(cell or '-' for cell in cells)} |"
    yield ""


def meanings_of(config_type: type) -> dict[str, str]:
    """What each ``:param:`` line of a dataclass and of those it extends says, as Markdown.

    :param config_type: the dataclass
    """
    style = docstring_parser.DocstringStyle.REST
    parsed = (docstring_parser.parse(base.__doc__ or "", style) for base in reversed(config_type.__mro__))
    return {p.arg_name: markdown(p.description or "") for docstring in parsed for p in docstring.params}


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
