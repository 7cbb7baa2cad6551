"""What Cosmic Ray changes in a file: numbers, arithmetic, comparisons, conditions, loops; and numbers by a tenth."""

import ast
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from cosmic_ray.commands import init
from cosmic_ray.mutating import use_mutation
from cosmic_ray.operators.number_replacer import NumberReplacer
from cosmic_ray.plugins import OPERATOR_PROVIDERS, get_operator
from cosmic_ray.work_db import use_db
from parso.python.tree import Number

FACTOR = 1.1
EXCLUDED = (
    r"core/("
    r"RemoveDecorator"  # without @property everything fails
    r"|.*_(RShift|LShift|BitOr|BitAnd|BitXor|FloorDiv|Mod|Pow)"  # mostly errors on floats
    r"|.*_(Invert|UAdd|USub_Not)|ReplaceComparisonOperator_(?!Is).*_Is(Not)?"  # errors, or the same as another
    r"|ReplaceComparisonOperator_Is(Not)?_(?!Is).*"  # the same for members of an enumeration and None
    r")"
)
"""Cosmic Ray's operators whose mutants say nothing: they would be killed by almost any test, or by none."""


class ScaledNumber(NumberReplacer):
    """Multiply a number that is no integer by 1.1; 0.0 stays to Cosmic Ray, which adds and subtracts 1."""

    def mutation_positions(self, node: Any) -> Iterator[tuple[Any, Any]]:
        """Where a syntax node can be changed: in one way, or not at all."""
        for position in list(super().mutation_positions(node))[:1]:
            if not node.value.isdigit() and float(node.value) != 0.0:
                yield position

    def mutate(self, node: Any, index: int) -> Number:
        """Change a node."""
        return Number(f" {FACTOR * float(node.value):.12g}", node.start_pos)


OPERATOR_PROVIDERS["sarah"] = {"ScaledNumber": ScaledNumber}


def annotations(code: str) -> list[tuple[tuple[int, int], tuple[int, int]]]:
    """Where types of variables, arguments and results begin and end: nothing there computes, and limits are rough."""
    nodes = (getattr(node, name, None) for node in ast.walk(ast.parse(code)) for name in ("annotation", "returns"))
    return [((n.lineno, n.col_offset), (n.end_lineno, n.end_col_offset)) for n in nodes if n is not None]


def mutations(file: Path, definitions: str) -> list[Any]:
    """Cosmic Ray's mutations of a file, in the order of its lines."""
    types = annotations(file.read_text())
    with use_db(":memory:") as session:
        init([file], session, {})
        found = [mutation for item in session.work_items for mutation in item.mutations]
    wanted = (
        mutation
        for mutation in found
        if not re.fullmatch(EXCLUDED, mutation.operator_name)
        and re.fullmatch(definitions, mutation.definition_name or "")
        and not any(start <= mutation.start_pos < end for start, end in types)
    )
    return sorted(wanted, key=lambda mutation: (mutation.start_pos, mutation.operator_name, mutation.occurrence))


@contextmanager
def mutated(mutation: Any) -> Iterator[tuple[int, str]]:
    """Context in which a file is changed; number and code of the changed line."""
    operator, line = get_operator(mutation.operator_name)(), mutation.start_pos[0]
    with use_mutation(mutation.module_path, operator, mutation.occurrence) as (_, code):
        yield line, code.splitlines()[line - 1].strip()
