"""Generated parts of the documentation: what stands between two comments of a page is written by a function.

``show("first_training.answer")`` prints what the function ``answer`` of that experiment's module makes of its rows. A
function whose name begins with ``figure`` draws a picture instead, which is shown.
"""

from __future__ import annotations

import re
import shlex
import sys
import textwrap
from collections.abc import Iterator
from pathlib import Path

from cogapp import Cog

from experiments import record
from experiments.experiment import Experiment
from experiments.found import PACKAGES, find, first_line, paths_of
from experiments.record import ROOT, Result, cell
from sarah.errors import ConfigurationError, unknown_name

PICTURES = ROOT / "docs" / "results"
"""Folder of the pictures."""
WIDTH = 120
"""Largest length of a line of text."""
PROLOGUE = "from docs.from_code import from_code; from experiments.pages import show"


def show(part: str) -> None:
    """Print a part of a page.

    :param part: name of an experiment and of a function of its module, joined by a dot
    :raises ConfigurationError: if there is no such experiment or function
    """
    name, _, function = part.partition(".")
    module = find(name)
    if function not in vars(module):
        raise ConfigurationError(unknown_name(f"part of {name}", function, vars(module)))
    if name not in record.names():
        text = f"*Still to be made: `{_command(name)}`.*"
    elif function.startswith("figure"):
        text = f"![{first_line(module.__doc__)}]({_picture(name, function).name})"
    else:
        result = record.read(name)
        text = _filled(getattr(module, function)(result.table))
        if "\n|" in text:
            text = f"{text}\n\n{_source(module.FULL, result)}"
    print(f"\n{text}\n")


def _filled(text: str) -> str:
    """Text whose paragraphs are broken into lines; tables stay."""
    return "\n\n".join(block if block.startswith("|") else _broken(block) for block in text.split("\n\n"))


def _broken(paragraph: str) -> str:
    whole = re.sub("`[^`]+`", lambda code: code[0].replace(" ", "\0"), paragraph)  # commands stay on their line
    return textwrap.fill(whole, WIDTH, break_long_words=False, break_on_hyphens=False).replace("\0", " ")


def _source(full: Experiment, result: Result) -> str:
    """The line below a table: how to make it or one of its rows again, where and when it was made, and its data."""
    command, cases = _command(result.name), full.cases()
    varying = [key for key, value in cases[0].items() if any(case[key] != value for case in cases)]
    only = shlex.join(word for key in varying for word in ("--only", f"{key}={cell(cases[-1][key])}"))
    sentences = [
        result.remark,
        f"Of {len(cases)} cases {result.missing} are still to be made." if result.missing else "",
        "" if result.options in ("", full.options) else f"Its options were not those of today: {result.options}.",
        f"{result.made_at} by `{command}`{_duration(result)}.",
        f"One of its cases alone: `{command} {only}`." if only else "",
        f"[Data](../../results/{result.name}.csv)",
    ]
    return _filled(" ".join(filter(None, sentences)))


def _duration(result: Result) -> str:
    """How long the cases took that have been made, in words."""
    if not result.minutes:
        return ""
    minutes, so_far = round(result.minutes), " so far" if result.missing else ""
    if minutes < 2:
        return f", in a minute or two{so_far}"
    time = f"{minutes} minutes" if minutes < 120 else f"{minutes / 60:.0f} hours"
    return f", in {time}{so_far} with one worker"


def _command(name: str) -> str:
    """Command that makes a result."""
    return next(f"{package.command} {name}" for package in PACKAGES if name in paths_of(package))


def _picture(name: str, function: str) -> Path:
    """File of a picture."""
    return PICTURES / f"{name}{function.removeprefix('figure')}.svg"


def pictures() -> Iterator[Path]:
    """Draw the pictures of all results."""
    import matplotlib.pyplot as plt

    from sarah.pictures.style import STYLE

    for name in paths_of():
        if name not in record.names():
            continue
        module, rows = find(name), record.read(name).table
        for function in (one for one in vars(module) if one.startswith("figure")):
            path = _picture(name, function)
            with plt.rc_context({**STYLE, "svg.hashsalt": name}):
                figure = getattr(module, function)(rows)
                figure.savefig(path, metadata={"Date": None})
                plt.close(figure)
            yield path


def pages() -> list[Path]:
    """All pages that have generated parts."""
    files = [*ROOT.glob("*.md"), *ROOT.glob("docs/**/*.md")]
    return sorted(file for file in files if "[[[cog" in file.read_text(encoding="utf-8"))


def write(check: bool = False) -> int:
    """Rewrite the generated parts of all pages.

    :param check: whether to change nothing, and only say what would change
    :return: 0; otherwise cog's number of a mistake, or of something that would change
    """
    # -P: a function prints its part; beside -r cog's --check would check nothing
    options = ("--check" if check else "-r", "-P", "-p", PROLOGUE)
    return int(Cog().main(["cog", *options, *map(str, pages())]))


if __name__ == "__main__":
    for drawn in pictures():
        print(drawn.relative_to(ROOT))
    sys.exit(write())
