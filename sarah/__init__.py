"""SARAH: a biped balanced by a pattern generator whose parameters are learned.

    >>> import sarah
    >>> result = sarah.simulate(sarah.EpisodeSpec(parameters=(0.4, 1.3, 0.1, 1.0, 1.0), seed=0))

Importing it registers ``SarahStepping-v0``, ``SarahBalance-v0``, ``SarahEpisode-v0`` and ``SarahOperation-v0`` with
gymnasium. On a robot's computer without gymnasium and numpy it registers nothing, and ``sarah.control`` can be used.
The names below are loaded when they are first used, so that importing the package is fast.
"""

from __future__ import annotations

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from sarah.control.constants import ControllerConstants
    from sarah.control.hip_law import BalanceParameters
    from sarah.control.parameters import BALANCE_PARAMETERS, STEPPING_PARAMETERS, Parameter
    from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
    from sarah.episode.ending import paper_ending
    from sarah.episode.episode import simulate
    from sarah.episode.evaluation import Evaluation, evaluate
    from sarah.episode.push import DrawnPush, Push, PushedConfig
    from sarah.episode.result import EpisodeResult
    from sarah.episode.reward import equation_2
    from sarah.episode.settings import EpisodeConfig
    from sarah.episode.spec import EpisodeSpec
    from sarah.episode.tasks import BALANCE, STEPPING, BalanceConfig, Task, load_task
    from sarah.episode.tick import Tick
    from sarah.errors import SarahError
    from sarah.operation.settings import Change, OperationConfig
    from sarah.operation.window import Window
    from sarah.robot.reading import SensorReading
    from sarah.runs.session import SessionSpec
    from sarah.simulation.physics import PHYSICS, Physics, PyBulletPhysics
    from sarah.simulation.randomisation import Randomisation
    from sarah.simulation.terrain import Terrain
    from sarah.training.operate import SessionResult, run_session

_NAMES = {
    "control.constants": ["ControllerConstants"],
    "control.hip_law": ["BalanceParameters"],
    "control.parameters": ["BALANCE_PARAMETERS", "STEPPING_PARAMETERS", "Parameter"],
    "control.pattern_generator": ["PatternGenerator", "SteppingParameters"],
    "episode.ending": ["paper_ending"],
    "episode.episode": ["simulate"],
    "episode.evaluation": ["Evaluation", "evaluate"],
    "episode.push": ["DrawnPush", "Push", "PushedConfig"],
    "episode.result": ["EpisodeResult"],
    "episode.reward": ["equation_2"],
    "episode.settings": ["EpisodeConfig"],
    "episode.spec": ["EpisodeSpec"],
    "episode.tasks": ["BALANCE", "STEPPING", "BalanceConfig", "Task", "load_task"],
    "episode.tick": ["Tick"],
    "errors": ["SarahError"],
    "operation.settings": ["Change", "OperationConfig"],
    "operation.window": ["Window"],
    "robot.reading": ["SensorReading"],
    "runs.session": ["SessionSpec"],
    "simulation.physics": ["PHYSICS", "Physics", "PyBulletPhysics"],
    "simulation.randomisation": ["Randomisation"],
    "simulation.terrain": ["Terrain"],
    "training.operate": ["SessionResult", "run_session"],
}
_HOMES = {name: module for module, names in _NAMES.items() for name in names}

__all__ = [
    "BALANCE",
    "BALANCE_PARAMETERS",
    "PHYSICS",
    "STEPPING",
    "STEPPING_PARAMETERS",
    "BalanceConfig",
    "BalanceParameters",
    "Change",
    "ControllerConstants",
    "DrawnPush",
    "EpisodeConfig",
    "EpisodeResult",
    "EpisodeSpec",
    "Evaluation",
    "OperationConfig",
    "Parameter",
    "PatternGenerator",
    "Physics",
    "Push",
    "PushedConfig",
    "PyBulletPhysics",
    "Randomisation",
    "SarahError",
    "SensorReading",
    "SessionResult",
    "SessionSpec",
    "SteppingParameters",
    "Task",
    "Terrain",
    "Tick",
    "Window",
    "equation_2",
    "evaluate",
    "load_task",
    "paper_ending",
    "run_session",
    "simulate",
]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'sarah' has no attribute {name!r}")
    return getattr(import_module(f"sarah.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_HOMES})


if find_spec("gymnasium") is not None:
    from sarah.envs.registration import register_environments

    register_environments()
