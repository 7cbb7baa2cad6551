"""The package's file of shipped parameters, damaged: one line that names the file and what is wrong."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from sarah.control.parameters import STEPPING_PARAMETERS
from sarah.episode import shipped as module
from sarah.episode.parameter_sets import learned_set
from sarah.episode.shipped import FILE, shipped, shipped_parameters
from sarah.errors import ConfigurationError

CONTENT = FILE.read_text(encoding="utf-8")


@pytest.fixture
def damaged(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Place of a file in which the shipped parameters are looked for."""
    path = tmp_path / FILE.name
    monkeypatch.setattr(module, "FILE", path)
    shipped.cache_clear()
    yield path
    shipped.cache_clear()


def changed(change: Callable[[Any], Any]) -> str:
    content = json.loads(CONTENT)
    change(content)
    return json.dumps(content)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (None, "cannot read .*: No such file or directory"),
        ("", "cannot read .*: Expecting value"),
        ("[" * 60_000, "cannot read .*"),
        ("\xff", "cannot read .*"),
        ("[]", "must hold parameters by name"),
        ("{}", "stepping is missing"),
        ('{"stepping": 1}', "stepping.parameters is missing"),
        (changed(lambda content: content["stepping"].pop("parameters")), "stepping.parameters is missing"),
        (changed(lambda content: content["stepping"]["parameters"].pop("P2")), "stepping.parameters.P2 is missing"),
        (changed(lambda content: content["stepping"]["parameters"].update(P6=1.0)), "stepping.parameters.P6 is not"),
        (changed(lambda content: content["stepping"]["parameters"].update(P3=2.5)), "stepping.parameters.P3 must be"),
        (changed(lambda content: content["stepping"]["parameters"].update(P3="1")), "stepping.parameters.P3 must be"),
    ],
)
def test_damaged_parameters_are_refused(text: str | None, message: str, damaged: Path) -> None:
    if text is not None:
        damaged.write_text(text, encoding="latin-1")
    with pytest.raises(ConfigurationError, match=message) as refused:
        shipped_parameters("stepping", STEPPING_PARAMETERS)
    assert str(damaged) in str(refused.value) and len(str(refused.value).splitlines()) == 1


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda content: content["balance"].pop("task"), "balance.task is missing"),
        (lambda content: content["balance"].update(task="balanc"), "balance: unknown task 'balanc'"),
        (lambda content: content["balance"].pop("origin"), "balance.origin is missing"),
        (lambda content: content["balance"]["settings"].update(steping=1), "balance: unknown key 'steping'"),
        (lambda content: content["balance"]["parameters"].pop("V4"), "balance.parameters.V4 is missing"),
    ],
)
def test_damaged_sets_are_refused(change: Callable[[Any], Any], message: str, damaged: Path) -> None:
    damaged.write_text(changed(change))
    with pytest.raises(ConfigurationError, match=message):
        learned_set("balance")


def test_the_order_of_the_parameters_in_the_file_does_not_matter(damaged: Path) -> None:
    expected = tuple(json.loads(CONTENT)["stepping"]["parameters"][parameter.name] for parameter in STEPPING_PARAMETERS)
    turned = {"stepping": {"parameters": dict(reversed(json.loads(CONTENT)["stepping"]["parameters"].items()))}}
    damaged.write_text(json.dumps(turned))
    assert shipped_parameters("stepping", STEPPING_PARAMETERS) == expected


@pytest.mark.parametrize("arguments", [("--help",), ("paper",), ("0.4,1.3,0.1,1,1",)])
@pytest.mark.parametrize("text", [None, "{", "{}", '{"stepping": {"parameters": {}}}'])
def test_commands_say_it_in_one_line(text: str | None, arguments: tuple[str, ...], tmp_path: Path) -> None:
    package = shutil.copytree(FILE.parents[1], tmp_path / "sarah", ignore=shutil.ignore_patterns("__pycache__"))
    copy = package / "episode" / FILE.name
    copy.unlink()
    if text is not None:
        copy.write_text(text)
    program = "import sys; sys.argv[0] = 'bin/sarah-eval'; from sarah.cli.eval import main; main()"
    process = subprocess.run(
        [sys.executable, "-c", program, *arguments],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        timeout=60,
        env={"PYTHONPATH": str(tmp_path)},
    )
    (line,) = process.stderr.splitlines()
    assert process.returncode == 2 and process.stdout == ""
    assert line.startswith("sarah-eval: error: ") and str(copy) in line
