"""YAML that somebody wrote: each key once, plain numbers, texts, lists and mappings, and nothing else."""

from __future__ import annotations

import re
from functools import lru_cache
from typing import Any, NoReturn

from sarah.errors import ConfigurationError, shortened
from sarah.number import NUMBER, WHOLE, number, whole_number

LONGEST_REASON = 500
"""Length up to which a message quotes that of a parser, in characters."""
TAG = "tag:yaml.org,2002:"
SPELLINGS = {
    "null": re.compile(r"(?:~|null|Null|NULL|)\Z"),
    "bool": re.compile(r"(?:true|True|TRUE|false|False|FALSE)\Z"),
    "int": WHOLE,
    "float": NUMBER,
}
"""Spellings of what is no text, where no quotes make a text of it."""


def read_yaml(text: str) -> Any:
    """Value of a YAML text, in which numbers are spelled as on the command line.

    YAML 1.1 makes 64 of ``0100``, 90 of ``1:30``, false of ``off`` and a text of ``1e-4``. Here the first three are
    texts, which are refused where a number is wanted, and the last one is a number.

    :param text: text of a file, or of an option
    :raises ConfigurationError: naming the line, for a key that is given twice or is no text, for anchors, aliases and
        tags, for depth without end, and for what is not YAML
    """
    import yaml

    try:
        return yaml.load(text, _loader())  # a safe loader, with less than the safe one has
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        if isinstance(error, ConfigurationError):
            raise
        reason = " ".join(str(error).split())[:LONGEST_REASON]
        raise ConfigurationError(f"it is not YAML: {reason}") from error


@lru_cache
def _loader() -> Any:
    """PyYAML's safe loader with spellings of our own; made when it is first needed, as importing YAML is slow."""
    import yaml

    class Loader(yaml.SafeLoader):
        def compose_node(self, parent: Any, index: Any) -> Any:
            """Refuse what makes a short text a large value: aliases, of which each can double it."""
            event = self.peek_event()
            anchor, tag = getattr(event, "anchor", None), getattr(event, "tag", None)
            if anchor is not None:
                _refuse(event, f"anchors and aliases are not allowed, such as {shortened(anchor)}")
            if tag is not None:
                _refuse(event, f"tags are not allowed, such as {shortened(tag)}")
            return super().compose_node(parent, index)

    def mapping(loader: Loader, node: Any) -> dict[str, Any]:
        content: dict[str, Any] = {}
        for key_node, value_node in node.value:
            key = loader.construct_object(key_node, deep=True)
            if not isinstance(key, str):
                _refuse(key_node, f"a key must be a text, not {shortened(key)}")
            if key in content:
                _refuse(key_node, f"key {shortened(key)} is given twice")
            content[key] = loader.construct_object(value_node, deep=True)
        return content

    Loader.yaml_implicit_resolvers = {}
    for kind, pattern in SPELLINGS.items():
        Loader.add_implicit_resolver(f"{TAG}{kind}", pattern, None)
    Loader.add_constructor(f"{TAG}int", lambda _, node: whole_number(node.value))
    Loader.add_constructor(f"{TAG}float", lambda _, node: number(node.value))
    Loader.add_constructor(f"{TAG}map", mapping)
    return Loader


def _refuse(place: Any, reason: str) -> NoReturn:
    raise ConfigurationError(f"line {place.start_mark.line + 1}: {reason}")
