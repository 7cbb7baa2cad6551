"""Colours with a meaning, the same in all pictures, which colour-blind people can tell apart (Okabe and Ito)."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import cycle

from sarah.scenery.push_arrow import PUSH as PUSH

LEFT, RIGHT = "#0072B2", "#D55E00"
"""Colours of the legs, as in the robot's visual shapes."""
PHASE_COLOURS = {"shift": "#AEB6C2", "lift": "#F2C14E", "land": "#7CC6A4"}
"""Colours of the pattern generator's phases."""
ALGORITHM_COLOURS = {
    "naf": "#0072B2",
    "td3": "#D55E00",
    "sac": "#009E73",
    "ddpg": "#CC79A7",
    "cma-es": "#E69F00",
    "gp": "#56B4E9",
    "tpe": "#F0E442",
    "random": "#000000",
}
"""Colours of the algorithms."""
SPARE_COLOURS = ("#332288", "#882255", "#999933", "#7F7F7F", "#8C564B", "#9BD770", "#FF9DA7")
"""Colours for algorithms without one of their own, all different from those."""


def algorithm_colours(algorithms: Iterable[str]) -> dict[str, str]:
    """Colours of algorithms in one picture. Those without an entry get spare ones, in the order of their names.

    :param algorithms: names of the algorithms, known or not
    :return: colours by name
    """
    spare = cycle(SPARE_COLOURS)
    return {name: ALGORITHM_COLOURS.get(name) or next(spare) for name in sorted(set(algorithms))}


def algorithm_label(algorithm: str) -> str:
    """Name of an algorithm in pictures and on pages.

    :param algorithm: name of the algorithm, known or not
    """
    return "random search" if algorithm == "random" else algorithm.upper()
