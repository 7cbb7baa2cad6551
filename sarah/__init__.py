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
    from sarah.control.constants import ControllerConstants
    from sarah.episode.episode import simulate
    from sarah.episode.evaluation import Evaluation, evaluate
    from sarah.episode.push import Push
    from sarah.episode.result import EpisodeResult
    from sarah.episode.settings import EpisodeConfig
    from sarah.episode.spec import EpisodeSpec
    from sarah.episode.tasks import BalanceConfig
    from sarah.errors import SarahError
    from sarah.simulation.physics import PHYSICS, Physics, PyBulletPhysics
    from sarah.simulation.randomisation import Randomisation

_HOMES = {
    "PHYSICS": "simulation.physics",
    "BalanceConfig": "episode.tasks",
    "ControllerConstants": "control.constants",
    "EpisodeConfig": "episode.settings",
    "EpisodeResult": "episode.result",
    "EpisodeSpec": "episode.spec",
    "Evaluation": "episode.evaluation",
    "Physics": "simulation.physics",
    "Push": "episode.push",
    "PyBulletPhysics": "simulation.physics",
    "Randomisation": "simulation.randomisation",
    "SarahError": "errors",
    "evaluate": "episode.evaluation",
    "simulate": "episode.episode",
}

__all__ = [
    "PHYSICS",
    "BalanceConfig",
    "ControllerConstants",
    "EpisodeConfig",
    "EpisodeResult",
    "EpisodeSpec",
    "Evaluation",
    "Physics",
    "Push",
    "PyBulletPhysics",
    "Randomisation",
    "SarahError",
    "evaluate",
    "simulate",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'sarah' has no attribute {name!r}")
    return getattr(import_module(f"sarah.{_HOMES[name]}"), name)


register_environments()
