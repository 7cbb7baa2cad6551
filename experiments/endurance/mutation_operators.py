"""An operator for Cosmic Ray: numbers that are 10 % off, as a wrong constant would be."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from cosmic_ray.operators.number_replacer import NumberReplacer
from parso.python.tree import Number

FACTOR = 1.1


class ScaledNumber(NumberReplacer):
    """Multiply a number that is no integer by 1.1; 0.0 stays to Cosmic Ray, which adds and subtracts 1."""

    def mutation_positions(self, node: Any) -> Iterator[tuple[Any, Any]]:
        """Where a syntax node can be changed: in one way, or not at all.

        :param node: node of the syntax tree
        """
        for position in list(super().mutation_positions(node))[:1]:
            if not node.value.isdigit() and float(node.value) != 0.0:
                yield position

    def mutate(self, node: Any, index: int) -> Number:
        """Change a node.

        :param node: number of the syntax tree
        :param index: number of the way; there is only one
        """
        return Number(f" {FACTOR * float(node.value):.12g}", node.start_pos)


OPERATORS = {"ScaledNumber": ScaledNumber}
"""The operators of this project, as Cosmic Ray takes them."""
