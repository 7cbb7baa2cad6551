"""Gradient updates per second of NAF and of stable-baselines3's TD3 with equal layers, on one thread.

Every round times each of them once, on random transitions, one after the other; ratios are medians over the rounds. The
last column is the time of the bare matrix products of NAF's update, forward and backward, as a share of the update's.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from statistics import median

import gymnasium as gym
import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3 import TD3
from stable_baselines3.common.logger import Logger
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from sarah.agents import NAF


class Noise(gym.Env):
    """Spaces of a size, and nothing to learn."""

    def __init__(self, observation_dim: int, action_dim: int) -> None:
        self.observation_space = spaces.Box(-1.0, 1.0, (observation_dim,))
        self.action_space = spaces.Box(-1.0, 1.0, (action_dim,))


def filled(model: OffPolicyAlgorithm, transitions: int = 2000) -> OffPolicyAlgorithm:
    """The model with random transitions in its replay buffer."""
    observation_dim, action_dim = model.observation_space.shape[0], model.action_space.shape[0]
    generator = np.random.default_rng(0)
    for _ in range(transitions):
        observations = generator.uniform(-1, 1, (2, 1, observation_dim)).astype(np.float32)
        action = generator.uniform(-1, 1, (1, action_dim)).astype(np.float32)
        done = generator.random(1) < 0.01
        model.replay_buffer.add(*observations, action, generator.normal(size=1), done, [{}])
    model.set_logger(Logger(None, []))
    return model


def products(model: NAF, batch_size: int) -> Callable[[int], None]:
    """The matrix products of updates: all layers on a batch with their gradients, and the target's V."""
    layers = [layer for layer in model.q_net.modules() if isinstance(layer, torch.nn.Linear)]
    target = [layer for layer in model.q_net.value_net if layer in layers]
    weights = {layer: torch.randn(layer.weight.shape) for layer in layers}
    inputs = {layer: torch.randn(batch_size, layer.in_features) for layer in layers}
    outputs = {layer: torch.randn(batch_size, layer.out_features) for layer in layers}

    def run(count: int) -> None:
        with torch.no_grad():
            for _ in range(count):
                for layer in layers:
                    torch.mm(inputs[layer], weights[layer].t())
                    torch.mm(outputs[layer].t(), inputs[layer])
                    if layer.in_features != model.observation_space.shape[0]:  # nothing learns from its gradient
                        torch.mm(outputs[layer], weights[layer])
                for layer in target:
                    torch.mm(inputs[layer], weights[layer].t())

    return run


def seconds(run: Callable[[int], None], updates: int) -> float:
    """Processor time of one update: other processes of the machine do not count."""
    start = time.process_time()
    run(updates)
    return (time.process_time() - start) / updates


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--updates", type=int, default=200, help="of each round")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--batch-size", type=int, default=256)
    options = parser.parse_args()
    torch.set_num_threads(1)
    print(
        "| layers | observations, actions | NAF updates/s | TD3 updates/s | NAF/TD3 | products' share |\n"
        + "|---" * 6
        + "|"
    )
    for layers in ([32, 32], [64, 64], [256, 256]):
        for dimensions in ((3, 1), (16, 5)):
            env = Noise(*dimensions)
            settings = dict(policy_kwargs=dict(net_arch=layers), buffer_size=5000, seed=0, device="cpu")
            naf, td3 = (filled(algorithm("MlpPolicy", env, **settings)) for algorithm in (NAF, TD3))
            runs = {
                "naf": lambda count, model=naf: model.train(count, options.batch_size),
                "td3": lambda count, model=td3: model.train(count, options.batch_size),
                "products": products(naf, options.batch_size),
            }
            for run in runs.values():
                run(20)
            rounds = [
                {name: seconds(run, options.updates) for name, run in runs.items()} for _ in range(options.rounds)
            ]
            times = {name: median(one[name] for one in rounds) for name in runs}
            print(
                f"| {' x '.join(map(str, layers))} | {dimensions[0]}, {dimensions[1]} | {1 / times['naf']:.0f} "
                f"| {1 / times['td3']:.0f} | {median(one['td3'] / one['naf'] for one in rounds):.2f} "
                f"| {median(one['products'] / one['naf'] for one in rounds):.2f} |",
                flush=True,
            )


if __name__ == "__main__":
    main()
