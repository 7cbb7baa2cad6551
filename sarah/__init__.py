"""SARAH: a biped balanced by a pattern generator whose parameters are learned.

    >>> import sarah
    >>> result = sarah.simulate(sarah.EpisodeSpec(parameters=(0.4, 1.3, 0.1, 1.0, 1.0), seed=0))

The names below are loaded when they are first used, so that importing the package is fast. Importing it also makes
``gymnasium.make("SarahStepping-v0")`` and ``gymnasium.make("SarahBalance-v0")`` work.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from sarah.registration import register_with_gymnasium

if TYPE_CHECKING:
    from sarah.config import PHYSICS, EpisodeConfig, Physics, Push, Randomisation
    from sarah.episode import EpisodeResult, EpisodeSpec, simulate
    from sarah.errors import SarahError

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
    "PHYSICS": "config",
    "EpisodeConfig": "config",
    "Physics": "config",
    "Push": "config",
    "Randomisation": "config",
    "EpisodeResult": "episode",
    "EpisodeSpec": "episode",
    "simulate": "episode",
    "SarahError": "errors",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'sarah' has no attribute {name!r}")
    return getattr(import_module(f"sarah.{_HOMES[name]}"), name)


register_with_gymnasium()
