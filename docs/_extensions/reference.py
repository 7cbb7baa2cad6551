"""Sphinx extension: writes the reference of settings and of P1 to V4 from the code, before the pages are read.

``reference/settings.md`` and ``reference/parameters.md`` include what is written here.
"""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import docstring_parser
from sphinx.application import Sphinx

from sarah.episode.tasks import TASKS
from sarah.runs.config import TrainingConfig

GENERATED = Path("reference") / "generated"


def settings_page() -> str:
    """A table for each group of settings of a training."""
    return "\n".join(_group("", TrainingConfig())) + "\n"


def _group(key: str, config: Any) -> Iterator[str]:
    """The tables of a dataclass and of the dataclasses in it.

    :param key: name of the group, with dots; empty for the outermost
    :param config: dataclass with its defaults
    """
    meanings = meanings_of(type(config))
    values = {field.name: getattr(config, field.name) for field in dataclasses.fields(config)}
    groups = {name: value for name, value in values.items() if dataclasses.is_dataclass(value)}
    yield f"## {f'`{key}`' if key else 'Training'}\n"
    yield "| setting | default | meaning |"
    yield "|---|---|---|"
    for name, value in values.items():
        if name not in groups:
            yield f"| `{key}.{name}` | {shown(value)} | {meanings[name]} |".replace("`.", "`")
    yield ""
    for name, value in groups.items():
        yield from _group(f"{key}.{name}".strip("."), value)


def parameters_page() -> str:
    """A table of each task's parameters."""
    lines = []
    for task in TASKS.values():
        lines += [f"## Task `{task.name}`", "", "| name | range | unit | meaning | paper |", "|---|---|---|---|---|"]
        for p in task.parameters:
            lines.append(f"| {p.name} | {p.low:g} to {p.high:g} | {p.unit or '-'} | {p.meaning} | {p.paper or '-'} |")
        lines.append("")
    return "\n".join(lines)


def meanings_of(config_type: type) -> dict[str, str]:
    """What each ``:param:`` line of a dataclass and of those it extends says, as Markdown.

    :param config_type: the dataclass
    """
    style = docstring_parser.DocstringStyle.REST
    parsed = (docstring_parser.parse(base.__doc__ or "", style) for base in reversed(config_type.__mro__))
    return {p.arg_name: markdown(p.description or "") for docstring in parsed for p in docstring.params}


def markdown(text: str) -> str:
    """One line of Markdown from a docstring's reStructuredText.

    :param text: of the docstring
    """
    text = re.sub(r":\w+(?::\w+)?:`~?([^`]+)`", r"`\1`", " ".join(text.split()))
    return text.replace("``", "`").replace("|", r"\|")


def shown(value: Any) -> str:
    """A default as the YAML file would hold it.

    :param value: the default
    """
    if isinstance(value, tuple):
        return f"`[{', '.join(map(str, value))}]`"
    if isinstance(value, bool):
        return f"`{str(value).lower()}`"
    return f"`{value}`" if value not in (None, {}, "") else "none"


def write_reference(app: Sphinx) -> None:
    """Write what the pages include.

    :param app: of Sphinx
    """
    folder = Path(app.srcdir) / GENERATED
    folder.mkdir(exist_ok=True)
    (folder / "settings.md").write_text(settings_page(), encoding="utf-8")
    (folder / "parameters.md").write_text(parameters_page(), encoding="utf-8")


def setup(app: Sphinx) -> dict[str, bool]:
    """Have the reference written before the pages are read."""
    app.connect("builder-inited", write_reference)
    return {"parallel_read_safe": True}
