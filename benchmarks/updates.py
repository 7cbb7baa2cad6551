"""How many updates per second does NAF make, and TD3?

NAF and the TD3 of stable-baselines3 have equal layers, on one thread. Every round times each of them once, on random
transitions, one after the other; ratios are medians over the rounds. The products are the bare matrix products of
NAF's update, forward and backward, as a share of the update's time. NAF is timed as it is, without dropout, and with V
in place of W: so without W, dropout, normalised layers and the pull.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from statistics import median
from typing import Any, TypeVar

import gymnasium as gym
import numpy as np
import torch
from gymnasium import spaces
from matplotlib.figure import Figure
from pandas import DataFrame
from stable_baselines3 import TD3
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from benchmarks.timing import Timing
from experiments.record import Row
from experiments.shapes import COLOURS, legend, panels
from experiments.tables import table
from sarah.agents import NAF

LAYERS = ((32, 32), (64, 64), (256, 256))
DIMENSIONS = ((3, 1), (16, 5), (348, 17))
"""Observations and actions."""
TRANSITIONS = 2000
WARM_UP = 20
"""Number of updates that are not timed."""
AgentType = TypeVar("AgentType", bound=OffPolicyAlgorithm)


@dataclass(frozen=True)
class Updates(Timing):
    """Updates per second of processor time: other processes of the machine do not count.

    :param updates: number of updates in a round
    :param rounds: number of rounds
    :param batch_size: number of transitions in the minibatch of an update
    """

    depends_on = ("agents",)
    updates: int = 60
    rounds: int = 7
    batch_size: int = 256

    def cases(self) -> list[Row]:
        """The sizes of layers, observations and actions."""
        return [
            {"layers": " x ".join(map(str, layers)), "observations": observations, "actions": actions}
            for layers in LAYERS
            for observations, actions in DIMENSIONS
        ]

    def rows(self, layers: str, observations: int, actions: int) -> Iterator[Row]:
        """Speed of updates.

        :param layers: widths of the layers
        :param observations: number of observations
        :param actions: number of actions
        """
        torch.set_num_threads(1)
        times = self._times(tuple(map(int, layers.split(" x "))), (observations, actions))
        yield {
            "naf_updates_per_second": round(1.0 / median(times["naf"])),
            "td3_updates_per_second": round(1.0 / median(times["td3"])),
            "naf_over_td3": ratio(times["td3"], times["naf"]),
            "naf_without_dropout_over_td3": ratio(times["td3"], times["naf without dropout"]),
            "naf_with_v_over_td3": ratio(times["td3"], times["naf with V"]),
            "products_share": ratio(times["products"], times["naf"]),
        }

    def _times(self, layers: tuple[int, ...], dimensions: tuple[int, int]) -> dict[str, list[float]]:
        """Seconds of an update in every round, by what is timed."""
        env, widths = Noise(*dimensions), list(layers)
        naf = filled(NAF, env, dict(net_arch=widths))
        models: dict[str, OffPolicyAlgorithm] = {
            "naf": naf,
            "naf without dropout": filled(NAF, env, dict(net_arch=widths, dropout=0)),
            "naf with V": filled(NAF, env, dict(net_arch=dict(V=widths, shared=widths, mu=[], L=[]))),
            "td3": filled(TD3, env, dict(net_arch=widths)),
        }
        timed: dict[str, Callable[[int], None]] = {
            name: partial(model.train, batch_size=self.batch_size) for name, model in models.items()
        }
        timed["products"] = products(naf, self.batch_size)
        for run in timed.values():
            run(WARM_UP)
        times: dict[str, list[float]] = {name: [] for name in timed}
        for _ in range(self.rounds):
            for name, run in timed.items():
                start = time.process_time()
                run(self.updates)
                times[name].append((time.process_time() - start) / self.updates)
        return times


class Noise(gym.Env):
    """Spaces of a size, and nothing to learn.

    :param observation_dim: number of observations
    :param action_dim: number of actions
    """

    def __init__(self, observation_dim: int, action_dim: int) -> None:
        self.observation_space = spaces.Box(-1.0, 1.0, (observation_dim,))
        self.action_space = spaces.Box(-1.0, 1.0, (action_dim,))


def ratio(upper: list[float], lower: list[float]) -> float:
    """Median of the rounds' ratios.

    :param upper: times of the rounds
    :param lower: times of the same rounds
    """
    return median(one / other for one, other in zip(upper, lower, strict=True))


def filled(algorithm: Callable[..., AgentType], env: gym.Env, policy_kwargs: dict[str, Any]) -> AgentType:
    """A model with random transitions in its replay buffer.

    :param algorithm: its class
    :param env: its spaces
    :param policy_kwargs: arguments of its policy
    """
    model = algorithm("MlpPolicy", env, policy_kwargs=policy_kwargs, buffer_size=5000, seed=0, device="cpu")
    assert model.replay_buffer is not None
    observation_dim, action_dim = spaces.flatdim(model.observation_space), spaces.flatdim(model.action_space)
    generator = np.random.default_rng(0)
    for _ in range(TRANSITIONS):
        observation, following = generator.uniform(-1, 1, (2, 1, observation_dim)).astype(np.float32)
        action = generator.uniform(-1, 1, (1, action_dim)).astype(np.float32)
        done = generator.random(1) < 0.01
        model.replay_buffer.add(observation, following, action, generator.normal(size=1), done, [{}])
    model.set_logger(Logger(None, []))
    return model


def products(model: NAF, batch_size: int) -> Callable[[int], None]:
    """The matrix products of updates: all layers on a batch with their gradients, and the target's W.

    :param model: an agent
    :param batch_size: number of transitions in a minibatch
    """
    layers = [layer for layer in model.q_net.modules() if isinstance(layer, torch.nn.Linear)]
    target = [layer for layer in model.q_net.value_net if layer in layers]
    weights = {layer: torch.randn(layer.weight.shape) for layer in layers}
    inputs = {layer: torch.randn(batch_size, layer.in_features) for layer in layers}
    outputs = {layer: torch.randn(batch_size, layer.out_features) for layer in layers}

    observation_dim = spaces.flatdim(model.observation_space)

    def run(count: int) -> None:
        with torch.no_grad():
            for _ in range(count):
                for layer in layers:
                    torch.mm(inputs[layer], weights[layer].t())
                    torch.mm(outputs[layer].t(), inputs[layer])
                    if layer.in_features != observation_dim:  # nothing learns from its gradient
                        torch.mm(outputs[layer], weights[layer])
                for layer in target:
                    torch.mm(inputs[layer], weights[layer].t())

    return run


FULL = Updates()
QUICK = Updates(updates=2, rounds=1, batch_size=8)


def figure(rows: DataFrame) -> Figure:
    """Updates per second of NAF and TD3."""
    drawn, (axis,) = panels(1, 0.3)
    for offset, algorithm, colour in ((-0.2, "naf", COLOURS[0]), (0.2, "td3", COLOURS[1])):
        places = [index + offset for index in range(len(rows))]
        axis.bar(places, rows[f"{algorithm}_updates_per_second"], 0.38, color=colour, label=algorithm.upper())
    labels = [f"{row.layers}\n{row.observations} → {row.actions}" for row in rows.itertuples()]
    axis.set_xticks(range(len(rows)), labels)
    axis.set_ylabel("updates per second")
    legend(drawn, axis)
    return drawn


def speeds(rows: DataFrame) -> str:
    """Updates per second, and the ratios."""
    heads = {
        "naf_updates_per_second": "NAF (1/s)",
        "td3_updates_per_second": "TD3 (1/s)",
        "naf_over_td3": "NAF over TD3",
        "naf_without_dropout_over_td3": "without dropout",
        "naf_with_v_over_td3": "with V",
        "products_share": "products' share",
    }
    formats = {**dict.fromkeys(("NAF over TD3", "without dropout", "with V"), ".2f"), "products' share": ".0%"}
    columns = ["layers", "observations", "actions", *heads.values()]
    caption = (
        "Updates per second with batches of 256, and speeds of NAF and two of its variants divided by that of TD3."
    )
    return table(rows.rename(columns=heads), columns, caption, **formats)
