"""Names from outside in Markdown, where they mean nothing but themselves."""

from __future__ import annotations

import re


def plain_text(text: str) -> str:
    """A name in a paragraph or a cell of a table.

    :param text: name, in which a bar would end the cell
    """
    return re.sub(r"([\\`*\[\]<>|~&])", r"\\\1", text)
