"""The learned parameters P1 to P5 and V1 to V4; every page, figure, help text and report takes them from here."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from sarah.errors import ConfigurationError, shortened
from sarah.number import is_number, plain, to_floats

Parameters = tuple[float, ...]
"""Values of some parameters, in their order."""
ROUNDING = 2.0**-22
"""Distance beyond an end of a range that comes from a 32-bit number, as a share of the larger end."""


@dataclass(frozen=True)
class Parameter:
    """A learned parameter of the controller.

    :param name: name as in the paper
    :param low: lowest value that a training tries
    :param high: highest value that a training tries
    :param unit: SI unit; empty for a number without one
    :param meaning: effect on the controller, as a noun phrase
    :param paper: value or remark that the paper gives
    :param length_scale: factor on the distance over which a training smooths outcomes, which it measures as a share of
        the range: below 1 where outcomes change fast
    """

    name: str
    low: float
    high: float
    unit: str
    meaning: str
    paper: str
    length_scale: float = 1.0

    def __post_init__(self) -> None:
        """Make floats of the numbers."""
        to_floats(self, "low", "high", "length_scale")

    @property
    def label(self) -> str:
        """Name with unit, for axes and tables."""
        return f"{self.name} ({self.unit})" if self.unit else self.name

    @property
    def description(self) -> str:
        """Meaning with unit, for help and hints."""
        return f"{self.meaning}, in {self.unit}" if self.unit else self.meaning

    @property
    def width(self) -> float:
        """Width of the range between the lowest and the highest value."""
        return self.high - self.low


@dataclass(frozen=True)
class Box:
    """The ranges of some parameters together.

    :param parameters: parameters, in order
    :param decimals: number of decimals to which values made of shares or of actions are rounded; all by default
    """

    parameters: tuple[Parameter, ...]
    decimals: int | None = None

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the parameters, in order."""
        return tuple(parameter.name for parameter in self.parameters)

    @property
    def length_scales(self) -> tuple[float, ...]:
        """Length scales of the parameters, in order."""
        return tuple(parameter.length_scale for parameter in self.parameters)

    @property
    def centre(self) -> Parameters:
        """Values in the middle of their ranges."""
        return self.unscaled([0.0] * len(self.parameters))

    def checked(self, values: Any, name: str = "parameters") -> Parameters:
        """Check one value for every parameter, and convert them to floats within the ranges.

        A value that lies beyond an end by the rounding of a 32-bit number comes to that end.

        :param values: values in the order of :attr:`parameters`
        :param name: name of the values in messages
        :raises ConfigurationError: naming the first value that is not a number within its range
        """
        values = plain(values)
        is_list = isinstance(values, (list, tuple))  # a set has no order
        if not is_list or len(values) != len(self.parameters):
            found, names = len(values) if is_list else shortened(values), self.names
            raise ConfigurationError(f"{name} must be {len(names)} numbers ({names[0]} to {names[-1]}), not {found}")
        checked = []
        for one, value in zip(self.parameters, values, strict=True):
            slack, given = ROUNDING * max(abs(one.low), abs(one.high)), plain(value)
            if not is_number(given) or not one.low - slack <= given <= one.high + slack:
                ends = f"{one.low:.15g} and {one.high:.15g}"
                raise ConfigurationError(f"parameter {one.name} must be between {ends}, not {shortened(value)}")
            checked.append(float(given))
        return self.clipped(checked)

    def clipped(self, values: Iterable[float]) -> Parameters:
        """Values of which those outside their range come to its nearer end.

        :param values: values in the order of :attr:`parameters`
        """
        return tuple(min(max(value, one.low), one.high) for one, value in zip(self.parameters, values, strict=True))

    def shares(self, values: Sequence[float]) -> Parameters:
        """Values as shares of their ranges, in which all parameters are alike: 0 at the low end, 1 at the high end.

        :param values: values in the order of :attr:`parameters`
        """
        return tuple((value - one.low) / one.width for one, value in zip(self.parameters, values, strict=True))

    def at_shares(self, shares: Iterable[float]) -> Parameters:
        """Values at shares of their ranges; what lies outside comes to the nearer end.

        :param shares: one number for each parameter
        """
        values = [one.low + one.width * float(share) for one, share in zip(self.parameters, shares, strict=True)]
        within = self.clipped(values)
        return within if self.decimals is None else tuple(round(value, self.decimals) for value in within)

    def scaled(self, values: Sequence[float]) -> Parameters:
        """Values as an action: the ranges are scaled to [-1, 1].

        :param values: values in the order of :attr:`parameters`
        """
        return tuple(2.0 * share - 1.0 for share in self.shares(values))

    def unscaled(self, action: Iterable[float]) -> Parameters:
        """Values that an action stands for; what lies outside [-1, 1] comes to the nearer end.

        :param action: one number for each parameter
        """
        return self.at_shares((number + 1.0) / 2.0 for number in action)


MATTERS, CONSTANT = "matters more than V2 and V4", "a constant that may be needed"

STEPPING_PARAMETERS = (
    Parameter("P1", 0.0, 2.0, "rad/s", "rate of rocking back at which the swing foot is put down", "about 0.4", 0.25),
    Parameter("P2", 0.0, 2.0, "m/s²", "tilt over the stance leg at which the swing foot may leave", "1.3"),
    Parameter(
        "P3",
        0.0,
        2.0,
        "rad/s",
        "a hundred times the rate towards the stance leg at which the swing foot may leave",
        "about 0.1",
    ),
    Parameter("P4", 0.0, 2.0, "", "longer time-out of LIFT, by the factor 1 + P4", "hardly matters"),
    Parameter("P5", 0.0, 2.0, "", "longer time-outs of SHIFT and LAND, by the factor 1 + P5", "hardly matters"),
)
"""P1 to P5. The paper observed that they must be positive; the upper ends are this project's. The
robot steps well on both sides of a P1 of 0.2, where it steps too fast: so P1 has a shorter length scale."""
BALANCE_PARAMETERS = (
    Parameter(
        "V1", -2.0, 2.0, "", "gain from lateral acceleration to abduction, and from tipping over to spread", MATTERS
    ),
    Parameter("V2", -2.0, 2.0, "m/s²", "constant added to the lateral acceleration", CONSTANT),
    Parameter("V3", -2.0, 2.0, "", "gain from a fall forward or backward to the step of a leg in the air", MATTERS),
    Parameter("V4", -2.0, 2.0, "", "constant flexion of both legs, in units of 0.02 rad", CONSTANT),
)
"""V1 to V4. The paper gives no numbers; the ranges are this project's."""
PAPER_STEPPING = (0.4, 1.3, 0.1, 1.0, 1.0)
"""Parameters of P1 to P5 that the paper's training found; P4 and P5 did not matter there and are set to 1 here."""
