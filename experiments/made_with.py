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
from collections.abc import Mapping
from dataclasses import astuple
from functools import lru_cache
from typing import Any, get_args
from xml.etree import ElementTree

from sarah import hips, mujoco_simulation, pattern_generator, simulation, simulator
from sarah.config import PHYSICS, Engine, EpisodeConfig, Push, Randomisation
from sarah.description import describe_robot
from sarah.engines import check_engine
from sarah.episode import EpisodeSpec, simulate
from sarah.errors import ConfigurationError
from sarah.pattern_generator import PAPER_PARAMETERS

TOLERANCE = 1e-6
PROBE_SECONDS = 4.0
PROBE_PUSH = Push(newtons=(80.0, 80.0), at_seconds=(1.5, 1.5))
PROBES = {"stepping": PAPER_PARAMETERS, "balance": (0.9, 0.1, 0.1, 0.1)}
"""Parameters by task; the rest of the episode is the project's own standard."""


@lru_cache
def made_with() -> dict[str, Any]:
    """Fingerprint of today's project: hashes of ``physics``, ``controller`` and ``robot``, and the ``probe``."""
    return {
        "physics": short_hash(_physics()),
        "controller": short_hash(_controller()),
        "robot": short_hash(canonical(describe_robot().urdf)),
        "probe": {f"{task}, {engine}": outcome(task, engine) for task in PROBES for engine in installed_engines()},
    }


def differences(then: Mapping[str, Any], now: Mapping[str, Any]) -> list[str]:
    """What of a fingerprint is another today: names for people.

    :param then: fingerprint of a result
    :param now: fingerprint of today's project; an engine that is not installed here is not compared
    """
    parts = [part for part in ("physics", "controller", "robot") if then[part] != now[part]]
    compared = then["probe"].keys() & now["probe"].keys()
    if not parts and any(
        abs(before - after) > TOLERANCE
        for episode in compared
        for before, after in zip(then["probe"][episode], now["probe"][episode], strict=True)
    ):
        parts.append("code of an episode")
    return parts


def outcome(task: str, engine: Engine) -> list[float]:
    """Score and final position of the probe's episode.

    :param task: name of the task
    :param engine: name of the engine
    """
    push = PROBE_PUSH if task == "balance" else Push()
    config = EpisodeConfig(engine=engine, time_limit=PROBE_SECONDS, push=push)
    result = simulate(EpisodeSpec(PROBES[task], 0, task, config))
    return [round(value, 9) for value in (result.score, *result.final_position)]


def installed_engines() -> list[Engine]:
    """Engines that can be asked here."""
    found: list[Engine] = []
    for engine in get_args(Engine):
        try:
            check_engine(engine)
        except ConfigurationError:
            continue
        found.append(engine)
    return found


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


def _physics() -> list[Any]:
    """Values of the named physics, the engines' constants and what is drawn for each episode."""
    return [
        [astuple(physics) for physics in PHYSICS.values()],
        [simulator.GRAVITY, simulation.CONTACT_SECONDS, simulation.CONTACT_MARGIN],
        [
            mujoco_simulation.CONTACT_STEPS,
            mujoco_simulation.CONTACT_SECONDS,
            mujoco_simulation.CONTACT_IMPEDANCE,
            mujoco_simulation.HIP_DAMPING,
            mujoco_simulation.LEG_DAMPING,
            mujoco_simulation.JOINT_DAMPING,
            mujoco_simulation.LOWEST_RATE,
        ],
        astuple(Randomisation()),
    ]


def _controller() -> list[Any]:
    """Values of the constants of the pattern generator and the hip law."""
    return [
        pattern_generator.MINIMUM_PHASE_SECONDS,
        pattern_generator.TIME_OUT_SECONDS,
        pattern_generator.RATE_SCALE,
        pattern_generator.PUSH_LENGTH,
        pattern_generator.LIFT_LENGTH,
        pattern_generator.LEG_SPEED,
        pattern_generator.TILT_TIME_CONSTANT,
        pattern_generator.RATE_TIME_CONSTANT,
        pattern_generator.ABDUCTION_TILT,
        pattern_generator.ABDUCTION_RATE_SHARE,
        hips.ABDUCTION_SCALE,
        hips.PITCH_SCALE,
        hips.FLEXION_SCALE,
        hips.LARGEST_ANGLE,
        hips.HIP_SPEED,
        hips.STABLE_TIME_CONSTANT,
        hips.PITCH_TIME_CONSTANT,
        hips.LARGEST_ACCELERATION,
        hips.LARGEST_RATE,
    ]
