"""Installed versions of Python and of the packages that results depend on."""

from __future__ import annotations

import platform
from importlib.metadata import PackageNotFoundError, version

PACKAGES = ("sarah", "pybullet", "mujoco", "numpy", "stable-baselines3", "gymnasium", "torch", "distributed")
SIMULATING = ("sarah", "pybullet", "mujoco", "numpy")
"""Packages that an episode's bytes depend on."""


def versions(packages: tuple[str, ...] = PACKAGES) -> dict[str, str]:
    """Versions by name, Python's first.

    :param packages: names of the distributions
    """
    found = {"python": platform.python_version()}
    for package in packages:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed as a distribution"
    return found
