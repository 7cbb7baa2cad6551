"""How much do exploration and replay decide what W converges to?

W is the mean value of replayed actions near mu, so it should fall behind what mu earns where actions are noisier, or
where the buffer remembers more. Beside it, the return of mu itself from the same states, discounted as W is, and the
share of a batch that the weights of W leave effective.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import gymnasium as gym
import numpy as np
import torch as th
from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.interquartile import interquartile_mean
from experiments.naf.learners import EVALUATION_SEED
from experiments.record import Row
from experiments.shapes import groups
from experiments.tables import shown, so_far, table
from sarah.agents import NAF
from sarah.agents.losses import nearby_weights

TASKS = ("Pendulum-v1", "HalfCheetah-v5")
DEFAULT_STD = 0.3
BATCHES = 20
"""Number of batches whose weights are looked at."""


@dataclass(frozen=True)
class Exploration(Experiment):
    """Trainings of NAF with noise of several widths and buffers of several sizes."""

    depends_on: ClassVar[tuple[str, ...]] = ("agents",)
    steps: int = 20_000  # of a training; a buffer of as many transitions forgets nothing
    small_buffer: int = 10_000  # number of transitions of a buffer that forgets
    seeds: int = 3  # number of trainings of each kind
    episodes: int = 5  # number of episodes in which mu is judged

    def cases(self) -> list[Row]:
        """Each training: the first seed of all first."""
        kinds = [(std, self.steps) for std in (0.1, 0.2, DEFAULT_STD, 0.4, 0.5)]
        kinds.insert(3, (DEFAULT_STD, self.small_buffer))
        return [
            {"task": case["task"], "exploration_std": std, "buffer": buffer, "seed": case["seed"]}
            for case in product(seed=range(self.seeds), task=TASKS)
            for std, buffer in kinds
        ]

    def rows(self, task: str, exploration_std: float, buffer: int, seed: int) -> Iterator[Row]:
        """What is learned, and what W says of it."""
        th.set_num_threads(1)
        model = NAF(
            "MlpPolicy", task, exploration_std=exploration_std, buffer_size=buffer, seed=seed, device="cpu"
        ).learn(self.steps)
        model.policy.set_training_mode(False)
        yield {**_judged(model, gym.make(task), self.episodes), "effective_share": _effective_share(model)}


FULL = Exploration()
QUICK = Exploration(steps=120, small_buffer=60, seeds=1, episodes=1)


def _judged(model: NAF, env: gym.Env, episodes: int) -> Row:
    """Returns of mu, plain and discounted, and W of the states where its episodes begin: means."""
    found = np.zeros((episodes, 3))
    for episode in range(episodes):
        observation, _ = env.reset(seed=EVALUATION_SEED + episode)
        with th.no_grad():
            found[episode, 2] = model.q_net.target_value(model.policy.obs_to_tensor(observation)[0]).item()
        discount, ended = 1.0, False
        while not ended:
            action, _ = model.predict(observation, deterministic=True)
            observation, reward, terminated, truncated, _ = env.step(action)
            found[episode, :2] += float(reward), discount * float(reward)
            discount *= model.gamma
            ended = terminated or truncated
    return dict(zip(("return", "discounted_return", "w"), found.mean(axis=0).tolist(), strict=True))


def _effective_share(model: NAF) -> float:
    """Share of a batch that would count as much if all of it counted alike: a mean over batches."""
    shares = []
    for _ in range(BATCHES):
        batch = model.replay_buffer.sample(model.batch_size)
        with th.no_grad():
            weights = nearby_weights(model.q_net.all_values(batch.observations, batch.actions).distance)
        shares.append(1.0 / (len(weights) * weights.square().sum().item()))
    return float(np.mean(shares))


def _of_kinds(rows: DataFrame) -> DataFrame:
    """A row for each kind of training: interquartile means of its seeds."""
    found: list[Row] = []
    for (task, std, buffer), of in groups(rows, "task", "exploration_std", "buffer").items():
        about = {"task": task, "exploration_std": std, "buffer": buffer, "seeds": so_far(len(of), FULL.seeds)}
        columns = ("return", "discounted_return", "w", "effective_share")
        found.append({**about, **{column: interquartile_mean(of[column])[0] for column in columns}})
    return DataFrame(found)


def answer(rows: DataFrame) -> str:
    """How far W is behind what mu earns, at the narrowest noise and at the widest."""
    sentences = []
    for task, of in groups(_of_kinds(rows), "task").items():
        full = of[of.buffer == of.buffer.max()].sort_values("exploration_std")
        behind = [f"{shown(row.discounted_return - row.w, '.1f')}" for _, row in full.iloc[[0, -1]].iterrows()]
        widths = [shown(std, ".1f") for std in full.exploration_std.iloc[[0, -1]]]
        sentences.append(
            f"On {task} W ends {behind[0]} below the discounted return of mu with noise of {widths[0]}, and "
            f"{behind[1]} below with {widths[1]}; the weights leave {shown(of.effective_share.mean(), '.0%')} of a "
            "batch effective."
        )
    return " ".join(sentences)


def values(rows: DataFrame) -> str:
    """W beside what mu earns, for each width of the noise and each buffer."""
    columns = ["task", "exploration_std", "buffer", "seeds", "return", "discounted_return", "w", "effective_share"]
    formats = {"exploration_std": ".1f", "return": ".1f", "w": ".1f", "effective_share": ".0%"}
    caption = f"Returns of mu and W where episodes begin, after {FULL.steps:,} steps: interquartile means."
    return table(_of_kinds(rows), columns, caption, **formats)
