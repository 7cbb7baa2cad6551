"""The two trainings of the paper: which parameters are learned, within which box.

Light on purpose: commands import it before anything slow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from numbers import Real

from sarah.errors import ConfigurationError


@dataclass(frozen=True)
class Task:
    """What is learned.

    :param name: of the task
    :param parameter_names: of what the agent chooses, in order
    :param low: end of every parameter's range
    :param high: the other end
    :param neutral: parameters that do nothing, which learned ones are compared with
    """

    name: str
    parameter_names: tuple[str, ...]
    low: float
    high: float
    neutral: tuple[float, ...] | None = None

    @property
    def width(self) -> float:
        """Width of every parameter's range."""
        return self.high - self.low

    def checked(self, values: Sequence[float], name: str = "parameters") -> tuple[float, ...]:
        """Take a value for every parameter as floats.

        :param values: in the order of :attr:`parameter_names`
        :param name: what the message calls them
        :raises ConfigurationError: naming the first one that is not a number within the box
        """
        names = self.parameter_names
        if len(values) != len(names):
            raise ConfigurationError(
                f"{name} must be {len(names)} numbers ({names[0]} to {names[-1]}), not {len(values)}"
            )
        for parameter, value in zip(names, values, strict=True):
            if not isinstance(value, Real) or isinstance(value, bool) or not self.low <= value <= self.high:
                raise ConfigurationError(
                    f"parameter {parameter} must be between {self.low:g} and {self.high:g}, not {value!r}"
                )
        return tuple(map(float, values))


STEPPING = Task("stepping", ("P1", "P2", "P3", "P4", "P5"), 0.0, 2.0)
"""The First Training: step fast, stay put. The paper observed that P1 to P5 must be positive."""
BALANCE = Task("balance", ("V1", "V2", "V3", "V4"), -2.0, 2.0, neutral=(0.0, 0.0, 0.0, 0.0))
"""The Second Training: come back after a push. The box is ours."""
TASKS = {task.name: task for task in (STEPPING, BALANCE)}
