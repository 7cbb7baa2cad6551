"""Parameters that the package ships, by name: something to look at without a training."""

from __future__ import annotations

from dataclasses import dataclass

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING


@dataclass(frozen=True)
class ParameterSet:
    """Parameters with a name.

    :param spec: episode of these parameters, with seed 0
    :param origin: where they come from
    """

    spec: EpisodeSpec
    origin: str


PARAMETER_SETS = {
    "paper": ParameterSet(EpisodeSpec(PAPER_STEPPING, 0, STEPPING), "P1 to P3 of the paper, with P4 = P5 = 1"),
    "stepping": ParameterSet(
        EpisodeSpec(TRAINED_STEPPING, 0, STEPPING), "P1 to P5 that NAF learned in a First Training, to two digits"
    ),
    "balance": ParameterSet(
        EpisodeSpec(
            (1.09, 0.17, 0.65, 1.13),
            0,
            BALANCE,
            BalanceConfig(stepping=(0.03, 0.14, 0.83, 1.34, 1.81), push=Push(newtons=(75.0, 125.0))),
        ),
        "P1 to P5 and V1 to V4 that NAF learns in both trainings of `make train`, to two digits",
    ),
}
"""Shipped parameters, by the name that commands take."""
