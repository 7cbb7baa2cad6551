"""What a topic of a log is: messages of one kind, with fields, a schema, and their way to JSON and back.

A message is one flat JSON object, so a field's name is also its path in a plotting program and its column in a table.
A number that is not finite, or that nobody knows, is left out.
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from sarah.errors import ConfigurationError, shortened
from sarah.number import is_finite, is_number, plain

Values = dict[str, Any]
"""Values of a message by the names of its fields."""
TYPES = {"number": float, "string": str, "boolean": bool}
"""Types in Python of JSON's types."""
_ENCODE = json.JSONEncoder(allow_nan=False, separators=(",", ":")).encode


@dataclass(frozen=True)
class Field:
    """A value of a message.

    :param name: name, which has no dots
    :param meaning: what it is, as a noun phrase
    :param unit: SI unit; empty for what has none
    :param kind: type in JSON
    """

    name: str
    meaning: str
    unit: str = ""
    kind: str = "number"

    @property
    def description(self) -> str:
        """Meaning with unit."""
        return f"{self.meaning}, in {self.unit}" if self.unit else self.meaning

    def allows(self, value: object) -> bool:
        """Whether it can have a value: a finite number, or one of its type.

        :param value: value of a message
        """
        if self.kind == "number":
            return is_number(value) and is_finite(value)
        return isinstance(value, TYPES[self.kind])


@dataclass(frozen=True)
class Topic:
    """Messages of one kind.

    :param name: name, with a slash before it
    :param schema: name of their schema
    :param meaning: when there is one, and what it tells
    :param fields: their values; numbers but the time may be missing
    :param values: function that makes the values of what the log is given
    """

    name: str
    schema: str
    meaning: str
    fields: tuple[Field, ...]
    values: Callable[..., Values]

    @cached_property
    def needed(self) -> tuple[str, ...]:
        """Names of the fields that every message has."""
        return tuple(field.name for field in self.fields if field.kind != "number" or field is self.fields[0])

    @property
    def json_schema(self) -> bytes:
        """Schema of the messages, as JSON Schema."""
        properties = {field.name: {"type": field.kind, "description": field.description} for field in self.fields}
        schema = {"title": self.schema, "description": self.meaning, "type": "object", "properties": properties}
        return json.dumps({**schema, "required": self.needed}).encode()

    def encoded(self, *given: Any) -> bytes:
        """JSON of a message.

        :param given: arguments of :attr:`values`
        """
        values = self.values(*given)
        types = self.types
        if not all(type(value) is types[name] for name, value in values.items()):
            values = self._known(values)
        try:
            return _ENCODE(values).encode()
        except ValueError:  # a number that is not finite
            return _ENCODE(self._known(values)).encode()

    @cached_property
    def types(self) -> dict[str, type]:
        """Types in Python of the fields, by name."""
        return {field.name: TYPES[field.kind] for field in self.fields}

    def _known(self, values: Values) -> Values:
        """Values that their fields may have, as Python's own.

        :raises KeyError: if one is missing that every message has
        """
        plained = {field: plain(values[field.name]) for field in self.fields if field.name in values}
        known = {field.name: value for field, value in plained.items() if field.allows(value)}
        return {name: known[name] for name in (*self.needed, *known)}

    def decoded(self, data: bytes) -> Values:
        """Values of a message.

        :param data: its JSON
        :raises ConfigurationError: if it is not one of this topic
        """
        try:
            values = json.loads(data)
        except (ValueError, RecursionError) as error:
            raise ConfigurationError(f"a message of {self.name} is not JSON") from error
        if not isinstance(values, dict):
            raise ConfigurationError(f"a message of {self.name} must be an object, not {shortened(values)}")
        for name in self.needed:
            if name not in values:
                raise ConfigurationError(f"a message of {self.name} has no {name}")
        for field in self.fields:
            if field.name in values and not field.allows(values[field.name]):
                given = shortened(values[field.name])
                raise ConfigurationError(f"{field.name} of {self.name} must be a {field.kind}, not {given}")
        return values
