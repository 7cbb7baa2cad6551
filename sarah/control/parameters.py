"""The learned parameters P1 to P5 and V1 to V4; every page, figure, help text and report takes them from here."""

from __future__ import annotations

from dataclasses import dataclass

from sarah.number import to_floats


@dataclass(frozen=True)
class Parameter:
    """A learned parameter of the controller.

    :param name: name as in the paper
    :param low: lowest value that a training tries
    :param high: highest value that a training tries
    :param unit: SI unit; empty for a number without one
    :param meaning: effect on the controller, as a noun phrase
    :param paper: value or remark that the paper gives
    """

    name: str
    low: float
    high: float
    unit: str
    meaning: str
    paper: str

    def __post_init__(self) -> None:
        """Make floats of the ends."""
        to_floats(self, "low", "high")

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


MATTERS, CONSTANT = "matters more than V2 and V4", "a constant that may be needed"

STEPPING_PARAMETERS = (
    Parameter("P1", 0.0, 2.0, "rad/s", "rate of rocking back at which the swing foot is put down", "about 0.4"),
    Parameter("P2", 0.0, 2.0, "m/s²", "tilt over the stance leg at which the swing foot may leave", "1.3"),
    Parameter(
        "P3", 0.0, 2.0, "rad/s", "a hundred times the rate over the stance leg at which it may leave", "about 0.1"
    ),
    Parameter("P4", 0.0, 2.0, "", "stretch of the time-out of LIFT", "hardly matters"),
    Parameter("P5", 0.0, 2.0, "", "stretch of the time-outs of SHIFT and LAND", "hardly matters"),
)
"""P1 to P5. The paper observed that they must be positive; the upper ends are this project's."""
BALANCE_PARAMETERS = (
    Parameter(
        "V1", -2.0, 2.0, "", "gain from lateral acceleration to abduction, and from tipping over to spread", MATTERS
    ),
    Parameter("V2", -2.0, 2.0, "m/s²", "constant added to that acceleration", CONSTANT),
    Parameter("V3", -2.0, 2.0, "", "gain from a fall forward or backward to the step of a leg in the air", MATTERS),
    Parameter("V4", -2.0, 2.0, "", "constant flexion of both legs, in units of 0.02 rad", CONSTANT),
)
"""V1 to V4. The paper gives no numbers; the ranges are this project's."""
PAPER_STEPPING = (0.4, 1.3, 0.1, 1.0, 1.0)
"""Values of P1 to P5 that the paper's training found; P4 and P5 did not matter there and are set to 1 here."""
