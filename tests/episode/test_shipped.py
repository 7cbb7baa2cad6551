"""The package's file of shipped parameters."""

import json
from pathlib import Path

import pytest

from sarah.control.parameters import STEPPING_PARAMETERS
from sarah.episode import shipped as module
from sarah.episode.shipped import FILE, shipped, shipped_parameters


def test_the_order_of_the_parameters_in_the_file_does_not_matter(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = json.loads(FILE.read_text(encoding="utf-8"))
    expected = tuple(content["stepping"]["parameters"][parameter.name] for parameter in STEPPING_PARAMETERS)
    turned = {"stepping": {"parameters": dict(reversed(content["stepping"]["parameters"].items()))}}
    (tmp_path / FILE.name).write_text(json.dumps(turned))
    monkeypatch.setattr(module, "FILE", tmp_path / FILE.name)
    shipped.cache_clear()
    try:
        assert shipped_parameters("stepping", STEPPING_PARAMETERS) == expected
    finally:
        shipped.cache_clear()
