"""The physics engines by name, and which of them are installed. None is imported here."""

from __future__ import annotations

from importlib.util import find_spec
from typing import Literal

from sarah.errors import ConfigurationError

Engine = Literal["pybullet", "mujoco"]
INSTALLATION = {
    "pybullet": "pip install pybullet (from Python 3.12 on it is compiled, which takes some minutes)",
    "mujoco": "pip install '.[mujoco]' in the clone",
}
"""Command that installs each engine."""


def default_engine() -> Engine:
    """Name of the engine to use by default: PyBullet, the reference, or MuJoCo where PyBullet is not installed."""
    return "pybullet" if is_installed("pybullet") else "mujoco"


def is_installed(engine: str) -> bool:
    """Whether an engine can be imported.

    :param engine: name of the engine, ``"pybullet"`` or ``"mujoco"``
    """
    spec = find_spec(engine)
    return spec is not None and spec.origin is not None  # `pip uninstall` may leave a folder without the package


def check_engine(engine: str) -> None:
    """Refuse an engine that is not installed.

    :param engine: name of the engine, ``"pybullet"`` or ``"mujoco"``
    :raises ConfigurationError: naming how to install it
    """
    if not is_installed(engine):
        raise ConfigurationError(f"engine {engine!r} needs the package {engine}: {INSTALLATION[engine]}")
