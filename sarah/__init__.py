"""SARAH: a biped balanced by a pattern generator whose parameters are learned.

    >>> import sarah
    >>> result = sarah.simulate(sarah.EpisodeSpec(parameters=(0.4, 1.3, 0.1, 1.0, 1.0), seed=0))

Importing it registers ``SarahStepping-v0`` and ``SarahBalance-v0`` with gymnasium. The names below are loaded when they
are first used, so that importing the package is fast.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sarah.envs.registration import register_environments

if TYPE_CHECKING:
    from sarah.episode.episode import simulate
    from sarah.episode.push import Push
    from sarah.episode.result import EpisodeResult
    from sarah.episode.spec import EpisodeConfig, EpisodeSpec
    from sarah.errors import SarahError
    from sarah.simulation.physics import PHYSICS, Physics
    from sarah.simulation.randomisation import Randomisation

__all__ = [
    "PHYSICS",
    "EpisodeConfig",
    "EpisodeResult",
    "EpisodeSpec",
    "Physics",
    "Push",
    "Randomisation",
    "SarahError",
    "simulate",
]

_HOMES = {
    "PHYSICS": "simulation.physics",
    "EpisodeConfig": "episode.spec",
    "EpisodeResult": "episode.result",
    "EpisodeSpec": "episode.spec",
    "Physics": "simulation.physics",
    "Push": "episode.push",
    "Randomisation": "simulation.randomisation",
    "SarahError": "errors",
    "simulate": "episode.episode",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'sarah' has no attribute {name!r}")
    return getattr(import_module(f"sarah.{_HOMES[name]}"), name)


register_environments()
