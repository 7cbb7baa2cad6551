"""Sphinx's settings: ``make docs`` builds the site into build/docs. Nothing is fetched from a network."""

from __future__ import annotations

import os
import subprocess
import sys
from importlib import metadata
from pathlib import Path

import yaml
from sphinx.application import Sphinx

HERE = Path(__file__).parent

project = "sarah"
author = "the sarah contributors"
release = metadata.version("sarah")
extensions = ["myst_parser", "sphinx.ext.autodoc"]
# The site is made of the files as they lie in the repository, so that links between them lead to the same pages.
root_doc = "docs/index"
include_patterns = [
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "docs/**",
    "examples/README.md",
    "experiments/README.md",
    "runs/README.md",
]
exclude_patterns = ["docs/reference/generated/modules.rst"]
html_theme = "furo"
html_extra_path = ["_root"]
html_static_path = ["_static"]
html_css_files = ["tables.css"]
html_title = f"sarah {release}"
html_show_copyright = False
myst_heading_anchors = 3
suppress_warnings = ["toc.duplicate_entry"]

CONTENTS: dict[str, dict[str, list[str]]] = yaml.safe_load((HERE / "contents.yml").read_text(encoding="utf-8"))
GENERATED = HERE / "reference" / "generated"
autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True


def write_api(app: Sphinx) -> None:
    """Write a page for every module; by the command, as the extension needs Python 3.11."""
    command = [str(Path(sys.executable).with_name("sphinx-apidoc")), "-q", "--force", "--separate", "--module-first"]
    environment = {**os.environ, "SPHINX_APIDOC_OPTIONS": "members,show-inheritance,ignore-module-all"}
    package = HERE.parent / "sarah"
    without_commands = str(package / "cli")  # commands have a page of their own
    arguments = ["--follow-links", "--output-dir", str(GENERATED), str(package), without_commands]
    subprocess.run([*command, *arguments], env=environment, check=True)


def add_contents(app: Sphinx, page: str, source: list[str]) -> None:
    """Add the contents below a page, which readers of the repository need not see."""
    for caption, pages in CONTENTS.get(page, {}).items():
        entries = "\n".join(f"/{name}" for name in pages)
        source[0] += f"\n```{{toctree}}\n:hidden:\n:caption: {caption}\n:maxdepth: 1\n\n{entries}\n```\n"


def skip_field(app: Sphinx, what: str, name: str, member: object, skip: bool, options: object) -> bool | None:
    """Leave out fields of named tuples, which their classes describe: each says only that it is field number 0 or 1."""
    return True if (member.__doc__ or "").startswith("Alias for field number") else None


def setup(app: Sphinx) -> None:
    """Have the pages of modules written before the others are read, and the contents added to these."""
    app.connect("autodoc-skip-member", skip_field)
    app.connect("builder-inited", write_api)
    app.connect("source-read", add_contents)
