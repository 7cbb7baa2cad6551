"""The protocol of a search: it is asked for parameters to try, and told what they were worth.

A training asks for episodes, of which several are in flight. It tells their returns in the order in which it asked,
without the part that known disturbances explain. A session asks for one window of a robot in operation after the other;
it says how many are left, and whether the robot fell. It uses nothing else that the robot knows, and no score.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

from sarah.control.parameters import Parameters
from sarah.runs.agent_settings import WARM_UP


class Search(Protocol):
    """A search for the best parameters within their box. The same seed gives the same parameters."""

    def ready(self) -> bool:
        """Whether it can be asked before it is told more. When all that it asked for is told, it can."""

    def ask(self, left: float = math.inf) -> Parameters:
        """The next parameters to try.

        :param left: number of tries that are left, this one included; a search that counts on later ones tries less
        """

    def tell(self, parameters: Parameters, merit: float, fell: bool = False) -> None:
        """Report what the oldest parameters that it was asked for, and not told of, were worth.

        :param parameters: parameters that were tried
        :param merit: number that is to be high
        :param fell: whether the robot fell, of which the merit says only a part
        """

    def choice(self) -> Parameters:
        """The parameters that it would leave a robot with now."""


@dataclass(frozen=True)
class Start:
    """How a search begins.

    :param first: parameters to try first; by default they are drawn as all others
    :param warm_up: number of tries before a model chooses, of searches that have a model
    :param slots: number of tries in flight
    """

    first: Parameters | None = None
    warm_up: int = WARM_UP
    slots: int = 1
