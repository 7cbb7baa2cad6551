"""Seeds of a training's random streams. Each stream has its own seed, so that none repeats the draws of another."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Seeds(NamedTuple):
    """Seeds of a training's random streams, each below 2^31.

    :param algorithm: seed of an agent's weights and warm-up, or of all that an optimiser draws
    :param exploration: seed of an agent's exploration after the warm-up, and of its minibatches
    :param episodes: seed of the seeds of the episodes that are learned from
    :param trials: seed of the seeds of the episodes that try the recommendation at the end
    """

    algorithm: int
    exploration: int
    episodes: int
    trials: int


def seeds_of(seed: int) -> Seeds:
    """Seeds of a training's random streams. Trainings of neighbouring seeds have none in common.

    :param seed: seed of the training
    """
    source = np.random.SeedSequence(seed)
    return Seeds(*(int(stream.generate_state(1)[0]) // 2 for stream in (source, *source.spawn(3))))
