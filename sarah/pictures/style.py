"""The style of plots: legible in print at the width of a column, and clear to colour-blind people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import matplotlib
import matplotlib.pyplot as plt
from matplotlib.figure import Figure

from sarah.files import check_name

COLUMN_WIDTH = 3.5
"""Width of a column on a two-column page, in inches."""
STYLE: dict[Any, Any] = {
    "font.size": 8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.linewidth": 0.4,
    "grid.alpha": 0.5,
    "legend.frameon": False,
    "pdf.fonttype": 42,  # text stays text, and is not drawn as curves
}


@contextmanager
def own_style(changes: Mapping[Any, Any] = {}) -> Iterator[None]:
    """Draw in the style of the package for a while, whatever style the caller or a file of his has set.

    :param changes: changes of :data:`STYLE`, by name
    """
    with plt.rc_context():
        matplotlib.rcdefaults()
        plt.rcParams.update(STYLE | dict(changes))
        yield


_suffixes: ContextVar[tuple[str, ...]] = ContextVar("suffixes", default=(".png", ".pdf"))


@contextmanager
def only_png() -> Iterator[None]:
    """Leave out PDF files for a while: where nobody keeps them, they take half of the time."""
    before = _suffixes.set((".png",))
    try:
        yield
    finally:
        _suffixes.reset(before)


def save(figure: Figure, path: Path) -> list[Path]:
    """Write a figure as PNG and PDF, or within :func:`only_png` as PNG, and close it.

    :param figure: figure to write
    :param path: path of the picture, without suffix
    :return: the files
    """
    check_name(path)
    files = [path.with_suffix(suffix) for suffix in _suffixes.get()]
    for file in files:
        figure.savefig(file, dpi=200)
    plt.close(figure)
    return files


def times(factor: float, name: str) -> str:
    """A parameter with its factor, which is left out if it is 1.

    :param factor: factor of the parameter
    :param name: name of the parameter
    """
    sign = "\N{MINUS SIGN}" if factor < 0.0 else ""
    return f"{sign}{name}" if abs(factor) == 1.0 else f"{sign}{abs(factor):.3g} {name}"
