"""Tests use the names that users have: what begins with an underscore is nobody else's business."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

TESTS = Path(__file__).parent
OWN = {"self", "cls"}
"""Objects whose private names a class uses itself."""
PUBLIC = {"_replace", "_asdict", "_fields", "_exit"}
"""Names that begin with an underscore, and that Python documents: of named tuples, and :func:`os._exit`."""


def is_private(name: object) -> bool:
    return isinstance(name, str) and name.startswith("_") and not name.startswith("__") and name not in PUBLIC


def private_names(source: str) -> Iterator[tuple[int, str]]:
    """Lines and names of other objects' private attributes, also of those that are named by a text or imported."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Attribute) and is_private(node.attr):
            if not (isinstance(node.value, ast.Name) and node.value.id in OWN):
                yield node.lineno, node.attr
        elif isinstance(node, ast.ImportFrom):
            yield from ((node.lineno, alias.name) for alias in node.names if is_private(alias.name))
        elif isinstance(node, ast.Call) and ast.unparse(node.func).split(".")[-1] in ("getattr", "setattr", "delattr"):
            texts = (argument.value for argument in node.args if isinstance(argument, ast.Constant))
            yield from (
                (node.lineno, text.split(".")[-1])
                for text in texts
                if isinstance(text, str) and is_private(text.split(".")[-1])
            )


@pytest.mark.parametrize("path", sorted(TESTS.rglob("*.py")), ids=lambda path: str(path.relative_to(TESTS)))
def test_tests_use_public_names(path: Path) -> None:
    assert list(private_names(path.read_text(encoding="utf-8"))) == []


@pytest.mark.parametrize(
    ("source", "name"),
    [
        ("episode._gait", "_gait"),
        ("from sarah.cli.eval import _changed", "_changed"),
        ("monkeypatch.setattr(workers, '_waiting', {})", "_waiting"),
        ("monkeypatch.setattr('sarah.cli.eval._changed', None)", "_changed"),
        ("getattr(model, '_n_updates')", "_n_updates"),
    ],
)
def test_private_names_are_found(source: str, name: str) -> None:
    assert list(private_names(source)) == [(1, name)]


@pytest.mark.parametrize(
    "source", ["self._seen = 1", "state._replace(x=1)", "os._exit(1)", "model.__dict__", "def _row(page): return page"]
)
def test_public_and_own_names_are_let_pass(source: str) -> None:
    assert list(private_names(source)) == []
