"""What a result was made with, in a form that tells whether today's project would make it again.

Three short hashes of values, without the names that these have in the code: a constant that is renamed or moved makes
no other result. And a probe, the outcome of one short episode of each task in each engine, which sees a change of the
code that no value shows. The probe is compared within :data:`TOLERANCE`: processors differ in the last bit, which an
episode of 4 s amplifies to some 1e-12.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import astuple
from functools import lru_cache
from typing import Any, get_args
from xml.etree import ElementTree

from sarah.control.constants import ControllerConstants
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.robot.description import describe_robot
from sarah.robot.reading import GRAVITY
from sarah.simulation.engines import Engine, is_installed
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import Randomisation

TOLERANCE = 1e-6
PROBE_SECONDS = 4.0
PROBE_PUSH = Push(newtons=(80.0, 80.0), at_seconds=(1.5, 1.5))
PROBES = {"stepping": PAPER_STEPPING, "balance": (0.9, 0.1, 0.1, 0.1)}
"""Parameters by task; the rest of the episode is the project's own standard."""
PROBE_STEPPING = (0.41, 0.52, 0.62, 1.17, 1.37)
"""P1 to P5 of the balance task, whatever the package ships: other parameters make no result stale."""
WITHOUT_EFFECT = {"landing_rate": 1.0}
"""Values of the controller's constants that are as if there were no such constant."""


@lru_cache
def made_with() -> dict[str, Any]:
    """Fingerprint of today's project: hashes of ``physics``, ``controller`` and ``robot``, and the ``probe``.

    Of an engine that is not installed here nothing is known.
    """
    return {
        "physics": {name: short_hash(values) for name, values in _physics().items()},
        "controller": short_hash(_controller()),
        "robot": short_hash(canonical(describe_robot().urdf)),
        "probe": {f"{task}, {engine}": outcome(task, engine) for task in PROBES for engine in installed_engines()},
    }


def _controller() -> tuple[float, ...]:
    return tuple(value for name, value in vars(ControllerConstants()).items() if value != WITHOUT_EFFECT.get(name))


def differences(then: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """What of a fingerprint is another today: names for people.

    :param then: fingerprint of a result
    :param now: fingerprint of today's project; an engine that is not installed here is not compared
    """
    parts = [part for part in ("controller", "robot") if then[part] != now[part]]
    if any(then["physics"][name] != now["physics"][name] for name in then["physics"].keys() & now["physics"].keys()):
        parts.insert(0, "physics")
    episodes = then["probe"].keys() & now["probe"].keys()
    if not parts and any(far(then["probe"][episode], now["probe"][episode]) for episode in episodes):
        parts.append("code of an episode")
    return parts


def far(then: Sequence[float], now: Sequence[float]) -> bool:
    """Whether two outcomes of an episode differ by more than processors do.

    :param then: outcome of the probe when a result was made
    :param now: outcome of the probe today
    """
    return any(abs(before - after) > TOLERANCE for before, after in zip(then, now, strict=True))


def outcome(task: str, engine: Engine) -> list[float]:
    """Score and final position of the probe's episode.

    :param task: name of the task
    :param engine: name of the engine
    """
    shared: dict[str, Any] = {"engine": engine, "time_limit": PROBE_SECONDS}
    config = (
        BalanceConfig(push=PROBE_PUSH, stepping=PROBE_STEPPING, **shared)
        if task == "balance"
        else EpisodeConfig(**shared)
    )
    result = simulate(EpisodeSpec(PROBES[task], 0, task, config))
    return [round(value, 9) for value in (result.score, *result.final_position)]


def installed_engines() -> list[Engine]:
    """Engines that can be asked here."""
    return [engine for engine in get_args(Engine) if is_installed(engine)]


def canonical(urdf: str) -> str:
    """A URDF without comments and white space, with numbers of nine digits: the last ones depend on the machine.

    :param urdf: the robot
    """
    text = ElementTree.canonicalize(urdf, strip_text=True)
    return re.sub(r"-?\d+\.\d+(?:e[+-]?\d+)?", lambda number: f"{float(number[0]):.9g}", text)


def short_hash(values: Any) -> str:
    """Twelve hexadecimal digits.

    :param values: numbers, texts, and lists of these
    """
    return hashlib.sha256(json.dumps(values).encode()).hexdigest()[:12]


def _physics() -> dict[str, list[Any]]:
    """Values of the named physics and of what is drawn for each episode, and each engine's constants."""
    named = [astuple(physics) for physics in PHYSICS.values()]
    engines = {engine: _constants(engine) for engine in installed_engines()}
    return {"settings": [named, GRAVITY, astuple(Randomisation())], **engines}


def _constants(engine: Engine) -> list[float]:
    if engine == "pybullet":
        from sarah.simulation import pybullet_simulator as pybullet

        return [pybullet.CONTACT_SECONDS, pybullet.CONTACT_MARGIN]
    from sarah.simulation import mujoco_model as model
    from sarah.simulation import mujoco_simulator as simulator

    return [
        model.CONTACT_STEPS,
        model.CONTACT_SECONDS,
        model.CONTACT_IMPEDANCE,
        simulator.HIP_DAMPING,
        simulator.LEG_DAMPING,
        model.JOINT_DAMPING,
        simulator.LOWEST_RATE,
    ]
