"""Names and commands from outside in Markdown, where they mean nothing but themselves."""

from __future__ import annotations

import re


def plain_text(text: str) -> str:
    """A name in a paragraph or a cell of a table.

    :param text: name, in which a bar would end the cell
    """
    return re.sub(r"([\\`*\[\]<>|~&])", r"\\\1", text)


def code(text: str) -> str:
    """A command in a paragraph.

    :param text: command, which may have backticks itself
    """
    ticks = "`" * (1 + max(map(len, re.findall("`+", text)), default=0))
    return f"{ticks}{text}{ticks}" if len(ticks) == 1 else f"{ticks} {text} {ticks}"
