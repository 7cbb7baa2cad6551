"""What each dimension of the robot is: its unit and its meaning, as the xacro says behind it."""

from __future__ import annotations

import re
from functools import lru_cache
from importlib import resources


@lru_cache(maxsize=1)
def words() -> dict[str, tuple[str, str]]:
    """Unit and meaning of each dimension, by name."""
    text = resources.files("sarah.urdf").joinpath("sarah.urdf.xacro").read_text(encoding="utf-8")
    found = re.findall(r'<xacro:arg name="(\w+)"[^>]*/> *<!-- (\S+): (.*?) -->', text)
    return {name: (unit, meaning) for name, unit, meaning in found}
