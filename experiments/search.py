"""A search for the best V1 to V4 of an engine: around known sets, by successive halving.

All candidates meet the same few pushes, the best of them more, and the last ones as many as the judge has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from sarah.control.parameters import BALANCE_PARAMETERS, Parameters

DEVIATION = (0.3, 0.8, 0.3, 0.8)
"""Standard deviation of candidates around a known set; what V2 and V4 do shows over longer distances."""


def successive_halving(
    candidates: Sequence[Parameters],
    rounds: Sequence[tuple[int, int]],
    scores: Callable[[Sequence[Parameters], int], Sequence[float]],
) -> list[Parameters]:
    """Candidates, the best first.

    :param candidates: sets to choose from
    :param rounds: number of the best that take part in each round, and number of episodes that they have met by its end
    :param scores: function that returns the scores of some sets after so many episodes
    """
    ranked = list(candidates)
    for count, episodes in rounds:
        part = ranked[:count]
        found = dict(zip(part, scores(part, episodes), strict=True))
        ranked[:count] = sorted(part, key=found.__getitem__, reverse=True)
    return ranked


def around(centres: Sequence[Parameters], count: int) -> list[Parameters]:
    """Sets drawn around known ones, within the box.

    :param centres: known sets
    :param count: number of sets to draw
    """
    generator = np.random.default_rng(0)
    low, high = ([getattr(parameter, end) for parameter in BALANCE_PARAMETERS] for end in ("low", "high"))
    drawn = []
    for _ in range(count):
        centre = centres[int(generator.integers(len(centres)))]
        drawn.append(tuple(map(float, generator.normal(centre, DEVIATION).clip(low, high))))
    return drawn
