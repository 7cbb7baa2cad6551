"""What results depend on beside their settings: this package's own sources, and the versions of others."""

from __future__ import annotations

import hashlib
import os
import platform
from collections.abc import Iterable, Mapping
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

SIMULATING = ("pybullet", "mujoco", "numpy", "xacro", "yourdfpy")
"""Packages that an episode's bytes depend on, beside this one."""
LEARNING = (*SIMULATING, "torch", "stable-baselines3", "gymnasium", "cma", "optuna", "scipy", "scikit-learn")
"""Packages that a training's bytes depend on, beside this one."""
LONGEST_SHOWN = 100
"""Largest number of characters of a value in a message."""
SOURCES = (".json", ".py", ".xacro")
"""Endings of the names of files that are hashed."""
SHOWING = ("cli", "logs", "pictures", "reports", "viewer")
"""Parts of this package that ask and show. No result depends on them, so they are not hashed."""


def versions(packages: Iterable[str] = LEARNING) -> dict[str, str]:
    """Versions by name: Python's, this package's with the hash of its sources, and those of other packages.

    :param packages: names of the distributions
    """
    found = {"python": platform.python_version(), "sarah": _version("sarah"), "sarah-sources": source_hash()}
    return found | {package: _version(package) for package in packages}


@lru_cache
def _version(package: str) -> str:
    try:
        return version(package)
    except PackageNotFoundError:
        return "not installed as a distribution"


@lru_cache
def source_hash(package: Path = Path(__file__).parent, endings: tuple[str, ...] = SOURCES) -> str:
    """Hash of a package's sources that results depend on, as they were when this process first asked.

    A version number stays the same over many states of the code; this does not.

    :param package: folder of the package, by default this one
    :param endings: endings of the names of the files that count
    :return: twelve hexadecimal digits
    """
    digest = hashlib.sha256()
    for path in sorted(_sources(package, endings), key=lambda path: path.relative_to(package).as_posix()):
        name, content = path.relative_to(package).as_posix().encode(), path.read_bytes()
        digest.update(b"%d %s %d " % (len(name), name, len(content)) + content)
    return digest.hexdigest()[:12]


def _sources(package: Path, endings: tuple[str, ...]) -> Iterable[Path]:
    # In a checkout, agents/ and urdf/ are links.
    for folder, folders, names in os.walk(package, followlinks=True):
        if Path(folder) == package:
            folders[:] = set(folders) - set(SHOWING)
        yield from (Path(folder, name) for name in names if name.endswith(endings))


def differences(here: Mapping[str, object], there: Mapping[str, object], other: str) -> str:
    """Say what differs between two places, such as their versions; nothing if they are the same.

    :param here: values of this process, by name
    :param there: values of the other place, by name
    :param other: words for the other place
    """
    return "; ".join(
        f"{_shown(name)} is {_shown(here.get(name, 'not known'))} here, and "
        f"{_shown(there.get(name, 'not known'))} {other}"
        for name in dict.fromkeys((*here, *there))
        if here.get(name) != there.get(name)
    )


def _shown(value: object) -> str:
    """A value as a terminal may print it, of a bounded length: it can come from a file that somebody else wrote."""
    text = str(value)
    return text if text.isprintable() and len(text) <= LONGEST_SHOWN else f"{ascii(text)[:LONGEST_SHOWN]}…"
