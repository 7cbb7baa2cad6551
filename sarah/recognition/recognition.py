"""A recognition: plain numbers that logs taught, written to a file that anybody may read and nobody executes."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Annotated, Any, Literal, NoReturn

from sarah.control.constants import ControllerConstants
from sarah.episode.from_mapping import convert_fields, from_mapping
from sarah.errors import ConfigurationError, SarahError, check_whole, shortened
from sarah.files import is_text, read_text
from sarah.operation.settings import BOX, SHIPPED, OperationConfig
from sarah.ranges import Within, check_ranges
from sarah.recognition.felt import FEATURES

Kind = Literal["nearest", "classes", "network", "model", "naf", "best"]
Numbers = tuple[float, ...]
Matrix = tuple[tuple[float, ...], ...]

SHIPPED_FILE = Path(__file__).with_name("recognition.json")
"""The recognition that the package ships."""
LARGEST_FILE = 2**20
"""Largest size of a file that is read, in bytes; the shipped one has some 20,000."""
LARGEST_NUMBER = 1e6
"""Largest number in a recognition, by amount."""
LARGEST_REWARD = 2.0
"""Largest expected reward, by amount: 1 is the best that a robot can do, and a process may overshoot."""
MOST = 1000
"""Largest number of kinds, of sets, of rows, and of a layer's units."""
LONGEST_NAME = 200
"""Largest number of characters in the name of a robot or a kind."""


@dataclass(frozen=True)
class Conditions:
    """What windows must have in common for their rewards and what is felt in them to be compared.

    :param settle_seconds: time that a window gives new parameters to settle, in s
    :param measure_seconds: time that a window measures, in s
    :param control_rate: rate of the controller, in Hz
    :param controller: constants of the controller
    """

    settle_seconds: Annotated[float, Within(0.0, 60.0, "s")] = 2.0
    measure_seconds: Annotated[float, Within(0.5, 600.0, "s")] = 4.0
    control_rate: Annotated[float, Within(1.0, 10_000.0, "Hz")] = 100.0
    controller: ControllerConstants = field(default_factory=ControllerConstants)

    def __post_init__(self) -> None:
        """Refuse values of another type, and those that no robot has."""
        convert_fields(self, "conditions.")
        check_ranges("conditions.", self)

    @classmethod
    def of(cls, config: OperationConfig) -> Conditions:
        """Conditions of an operation.

        :param config: settings of the operation
        """
        rate, controller = float(config.robot.physics.control_rate), config.robot.controller
        return cls(config.settle_seconds, config.measure_seconds, rate, controller)

    def check(self, others: Conditions, name: str) -> None:
        """Refuse windows of other conditions.

        :param others: their conditions
        :param name: name of what they are from
        :raises ConfigurationError: naming the first value that differs
        """
        for key, here, there in _differences(self, others):
            size = " (which goes with the robot's size)" if key == "control_rate" else ""
            raise ConfigurationError(f"{name} has {key} {there!r}, not {here!r}{size}: what is felt cannot be compared")


@dataclass(frozen=True)
class Layer:
    """A layer of a network: its outputs are weights times inputs, plus biases.

    :param weights: weights, a row for each output
    :param biases: biases
    """

    weights: Matrix
    biases: Numbers


@dataclass(frozen=True)
class Recognition:
    """What logs teach: which robot one is, by what it feels with the reference, and which sets are known for it.

    What is felt is a place: features (:data:`~sarah.recognition.felt.FEATURES`) less their centre, times the whitening,
    in units of what they vary by from window to window. All empty, it knows nothing.

    :param kind: way of learning that made it
    :param conditions: conditions of the windows that it is of
    :param reference: parameters, P1 to P5 and V1 to V4, with which robots are recognised
    :param centre: mean of the features
    :param whitening: matrix with a row for each coordinate of a place
    :param far: distance from all known places beyond which a robot is unknown
    :param kinds: names of the kinds of robots
    :param places: place of each kind
    :param sets: parameters of each set; the first one is the reference
    :param rewards: observed reward of each set, expected on each kind
    :param deviations: standard deviation of each
    :param layers: layers of the network that tells kinds apart by their places; one is a linear discriminant. Between
        layers is a hyperbolic tangent. None where the distance tells
    :param rows: sets that robots of each kind have tried: index of the kind, parameters and mean reward. With the kind
        ``model`` they are what it knows, else those around the best set and the reference
    """

    kind: Kind = "nearest"
    conditions: Conditions = field(default_factory=Conditions)
    reference: Numbers = SHIPPED
    centre: Numbers = (0.0,) * len(FEATURES)
    whitening: Matrix = ()
    far: Annotated[float, Within(0.0, LARGEST_NUMBER)] = 0.0
    kinds: tuple[str, ...] = ()
    places: Matrix = ()
    sets: Matrix = ()
    rewards: Matrix = ()
    deviations: Matrix = ()
    layers: tuple[Layer, ...] = ()
    rows: Matrix = ()

    def __post_init__(self) -> None:
        """Refuse what does not fit together."""
        convert_fields(self)
        check_ranges("", self)
        object.__setattr__(self, "reference", BOX.checked(self.reference, "reference"))
        object.__setattr__(self, "sets", tuple(BOX.checked(one, f"sets.{i}") for i, one in enumerate(self.sets)))
        for index, name in enumerate(self.kinds):
            if not name or len(name) > LONGEST_NAME or not is_text(name):
                raise ConfigurationError(f"kinds.{index} must be a name of one line, not {shortened(name)}")
        if self.kinds and self.sets[:1] != (self.reference,):
            raise ConfigurationError("sets.0 must be the reference")
        kinds, sets, coordinates = len(self.kinds), len(self.sets), len(self.whitening)
        for name, count in (
            ("kinds", kinds),
            ("sets", sets),
            ("whitening", coordinates),
            ("layers", len(self.layers)),
            ("rows", len(self.rows)),
        ):
            if count > MOST:
                raise ConfigurationError(f"{name} must be at most {MOST}, not {count}")
        _check("centre", (self.centre,), (1, len(FEATURES)))
        _check("whitening", self.whitening, (coordinates, len(FEATURES)))
        _check("places", self.places, (kinds, coordinates))
        _check("rewards", self.rewards, (sets, kinds), -LARGEST_REWARD, LARGEST_REWARD)
        _check("deviations", self.deviations, (sets, kinds), low=0.0)
        for index, row in enumerate(self.rows):
            _check(f"rows.{index}", (row,), (1, len(BOX.names) + 2))
            _check(f"rows.{index}.{len(row) - 1}", (row[-1:],), (1, 1), -LARGEST_REWARD, LARGEST_REWARD)
            check_whole(f"rows.{index}.0", row[0] if row[0] % 1.0 else int(row[0]), 0, len(self.kinds) - 1)
            BOX.checked(row[1:-1], f"rows.{index}")
        width = coordinates
        for index, layer in enumerate(self.layers):
            is_last = index == len(self.layers) - 1
            width_after = kinds if is_last else max(1, min(len(layer.biases), MOST))
            _check(f"layers.{index}.weights", layer.weights, (width_after, width))
            _check(f"layers.{index}.biases", (layer.biases,), (1, width_after))
            width = width_after

    @cached_property
    def identity(self) -> str:
        """Digest of all numbers, which names it in a session's specification."""
        return hashlib.sha256(self.text().encode()).hexdigest()[:16]

    def text(self) -> str:
        """All of it as JSON, a list of numbers on a line."""
        return _json(dataclasses.asdict(self)) + "\n"


def read_recognition(path: Path) -> Recognition:
    """Read a recognition, whoever wrote it.

    :param path: path of the file
    :raises ConfigurationError: naming the file and what is wrong in it
    """
    try:
        content = json.loads(read_text(path, LARGEST_FILE), parse_constant=_refuse_constant)
        return from_mapping(Recognition(), content)
    except OSError as error:
        raise ConfigurationError(f"cannot read {path}: {error.strerror or error}") from error
    except (SarahError, ValueError, RecursionError) as error:
        reason = " ".join(str(error).split()) if not isinstance(error, RecursionError) else "it is nested without end"
        raise ConfigurationError(f"{path} is not a recognition: {reason:.300}") from error


@lru_cache
def shipped_recognition() -> Recognition:
    """The recognition that the package ships."""
    return read_recognition(SHIPPED_FILE)


def _refuse_constant(name: str) -> NoReturn:
    raise ValueError(f"{name} is no number")


def _check(
    name: str,
    matrix: Sequence[Sequence[float]],
    shape: tuple[int, int],
    low: float = -LARGEST_NUMBER,
    high: float = LARGEST_NUMBER,
) -> None:
    """Refuse a matrix of another shape, and numbers that are too large or none."""
    if len(matrix) != shape[0] or any(len(row) != shape[1] for row in matrix):
        raise ConfigurationError(f"{name} must be {shape[0]} times {shape[1]} numbers")
    for value in (value for row in matrix for value in row):
        if not low <= value <= high:
            raise ConfigurationError(f"{name} must be numbers from {low:g} to {high:g}, not {value!r}")


def _differences(here: Conditions, there: Conditions) -> list[tuple[str, Any, Any]]:
    values, others = ({**vars(one), **vars(one.controller)} for one in (here, there))
    return [(key, values[key], others[key]) for key in values if key != "controller" and values[key] != others[key]]


def _json(value: Any, indent: str = "") -> str:
    """JSON in which what holds no lists or mappings stands on one line."""
    inner = f"{indent} "
    if isinstance(value, dict):
        items = [f"{json.dumps(key)}: {_json(item, inner)}" for key, item in value.items()]
        opening, closing = "{}"
    elif isinstance(value, (list, tuple)) and any(isinstance(item, (list, tuple, dict)) for item in value):
        items, (opening, closing) = [_json(item, inner) for item in value], "[]"
    else:
        return json.dumps(value)
    return f"{opening}\n{inner}" + f",\n{inner}".join(items) + f"\n{indent}{closing}" if items else opening + closing
