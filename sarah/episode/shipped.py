"""The file of learned parameters that the package ships, which ``make results NAME=shipped_parameters`` writes."""

from __future__ import annotations

import json
from functools import lru_cache
from pathlib import Path
from typing import Any

FILE = Path(__file__).with_name("parameter_sets.json")


@lru_cache
def shipped() -> dict[str, dict[str, Any]]:
    """Content of the file, by the name of the parameters: task, parameters, settings, figures and origin."""
    content: dict[str, dict[str, Any]] = json.loads(FILE.read_text(encoding="utf-8"))
    return content
