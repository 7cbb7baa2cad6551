"""Sphinx's settings: ``make docs`` builds the site into build/docs. Nothing is fetched from a network."""

from __future__ import annotations

import os
import subprocess
import sys
import textwrap
from importlib import metadata
from pathlib import Path

from sphinx.application import Sphinx

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE / "_extensions"), str(HERE.parent)]  # what renders results, and what reads them

project = "sarah"
author = "the sarah contributors"
release = metadata.version("sarah")
extensions = ["myst_parser", "sphinx.ext.autodoc", "reference", "results"]
html_theme = "furo"
html_static_path = ["_static"]
html_css_files = ["tables.css"]
html_title = f"sarah {release}"
# Other pages include the former, reference/api.md leads past the last.
INCLUDED = (
    *("commands", "defaults", "dimensions", "examples", "metrics"),
    *("parameters", "rates", "settings", "signals", "targets"),
)
exclude_patterns = [*(f"reference/generated/{name}.md" for name in INCLUDED), "reference/generated/modules.rst"]
html_show_copyright = False
myst_heading_anchors = 3
suppress_warnings = ["toc.duplicate_entry"]

WIDTH = 86
"""Of a command's help, in characters: as wide as the page."""
GENERATED = HERE / "reference" / "generated"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True


def write_commands(app: Sphinx) -> None:
    """Write what every command says to ``--help``, in the order of setup.cfg."""
    environment = {**os.environ, "COLUMNS": str(WIDTH), "NO_COLOR": "1"}
    commands = [
        command.name for command in metadata.entry_points(group="console_scripts") if command.name.startswith("sarah-")
    ]
    sections = []
    for command in commands:
        path = Path(sys.executable).with_name(command)
        process = subprocess.run([path, "--help"], env=environment, capture_output=True, text=True, check=True)
        # tyro leaves what a command says of itself to the terminal to wrap.
        lines = (textwrap.fill(line, WIDTH) if len(line) > WIDTH else line for line in process.stdout.splitlines())
        text = "\n".join(lines).strip()
        sections.append(f"## {command}\n\n```text\n{text}\n```\n")
    GENERATED.mkdir(exist_ok=True)
    (GENERATED / "commands.md").write_text("\n".join(sections), encoding="utf-8")


def write_api(app: Sphinx) -> None:
    """Write a page for every module; by the command, as the extension needs Python 3.11."""
    command = [Path(sys.executable).with_name("sphinx-apidoc"), "-q", "--force", "--separate", "--module-first"]
    environment = {**os.environ, "SPHINX_APIDOC_OPTIONS": "members,show-inheritance,ignore-module-all"}
    arguments = ["--follow-links", "--output-dir", str(GENERATED), str(HERE.parent / "sarah")]
    subprocess.run([*command, *arguments], env=environment, check=True)


def setup(app: Sphinx) -> None:
    """Have the references of commands and modules written before the pages are read."""
    app.connect("builder-inited", write_api)
    app.connect("builder-inited", write_commands)
