"""Drivers from files of the user's: ``my_robot.py:ROBOT``."""

from __future__ import annotations

import contextlib
import runpy
import sys
from collections.abc import Iterator
from pathlib import Path

from sarah.drivers.driver import Driver
from sarah.episode.tasks.task_file import mistake
from sarah.errors import ConfigurationError, SarahError, unknown_name
from sarah.robot.reading import ACTUATED_JOINTS


def read_driver(reference: str) -> Driver:
    """Run a file, which finds modules beside it, and return a driver that it makes.

    :param reference: path of the file, a colon, and the name of the driver in the file
    :raises ConfigurationError: naming file, line and mistake, or the drivers that the file has
    """
    path, _, name = reference.rpartition(":")
    if not path or not name:
        raise ConfigurationError(f"--driver must be a file and a name, such as my_robot.py:ROBOT, not {reference!r}")
    if not Path(path).is_file():
        raise ConfigurationError(f"there is no file {path} with a driver")
    sys.path.insert(0, str(Path(path).resolve().parent))
    try:
        found = runpy.run_path(path, run_name=Path(path).stem)
    except (Exception, SystemExit) as error:
        raise ConfigurationError(mistake(path, error)) from error
    drivers = {key: value for key, value in found.items() if isinstance(value, Driver)}
    if name not in drivers:
        raise ConfigurationError(unknown_name(f"driver in {path}", name, drivers))
    if not hasattr(drivers[name], "limits"):
        joints = ", ".join(ACTUATED_JOINTS)
        raise ConfigurationError(f"{reference} needs limits: lowest and highest position of each of {joints}")
    return drivers[name]


@contextlib.contextmanager
def mistakes_of(reference: str) -> Iterator[None]:
    """Context in which what a driver raises becomes one line.

    :param reference: file and name of the driver
    :raises ConfigurationError: naming file, line and mistake
    """
    path = reference.rpartition(":")[0]
    try:
        yield
    except SarahError:
        raise
    except Exception as error:
        raise ConfigurationError(mistake(path, error)) from error
