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
