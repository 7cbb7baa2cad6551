"""NAF on a log as replay: for each kind the set that it would choose, which nobody need have tried."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import gymnasium
import numpy as np
from stable_baselines3.common.logger import Logger

from sarah.agents import NAF, PRESETS
from sarah.control.parameters import Parameters
from sarah.operation.settings import BOX

STEPS = 800
"""Number of gradient steps."""
SHARED = ("learning_rate", "batch_size", "gamma", "max_grad_norm", "policy_kwargs")
"""Settings of the preset for episodes of one step that count without exploration."""


class _Replayed(gymnasium.Env[np.ndarray, np.ndarray]):
    """Spaces of a log: places are observations, and sets are actions. It never runs."""

    def __init__(self, coordinates: int) -> None:
        self.observation_space = gymnasium.spaces.Box(-10.0, 10.0, (coordinates,))
        self.action_space = gymnasium.spaces.Box(-1.0, 1.0, (len(BOX.names),))


def chosen_sets(places: np.ndarray, windows: Sequence[tuple[int, Parameters, float]]) -> list[Parameters]:
    """Sets that NAF chooses after it has learned from windows.

    :param places: place of each kind
    :param windows: kind, parameters and reward of each window
    :return: a set for each kind
    """
    observations = (places / max(float(np.abs(places).max()), 1e-9)).astype(np.float32)
    settings: dict[str, Any] = {name: PRESETS["one-step"][name] for name in SHARED}
    model = NAF("MlpPolicy", _Replayed(places.shape[1]), seed=0, device="cpu", buffer_size=len(windows), **settings)
    model.set_logger(Logger(None, []))
    buffer = model.replay_buffer
    assert buffer is not None
    for kind, parameters, reward in windows:
        seen, action = observations[kind][None], np.array([BOX.scaled(parameters)])
        buffer.add(seen, seen, action, np.array([reward]), np.array([True]), [{}])
    model.train(STEPS, settings["batch_size"])
    actions, _ = model.predict(observations, deterministic=True)
    return [BOX.unscaled(action) for action in actions]
