"""How much do exploration and replay decide what W converges to?

W is the mean value of replayed actions near mu. So it should fall behind what mu earns where actions are noisier, or
where the buffer remembers more of what the agent did earlier. Beside it are the returns of mu alone and of mu with its
noise, from the same states and discounted as W is, and the share of a batch that the weights of W leave effective.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import ClassVar

import gymnasium as gym
import numpy as np
import torch as th
from pandas import DataFrame, Series

from experiments.experiment import Experiment, product
from experiments.naf.learners import EVALUATION_SEED
from experiments.record import Row
from experiments.shapes import groups
from experiments.tables import shown, so_far, table
from sarah.agents import NAF
from sarah.agents.losses import nearby_weights

TASKS = ("Pendulum-v1", "HalfCheetah-v5")
STDS = (0.1, 0.3, 0.5)
"""Standard deviations of the noise; that in the middle is NAF's default."""
LONG = 1_000
"""Steps of an episode in which mu is judged: what follows counts less than 0.0001, and W knows no time limit."""
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
        buffers = (self.steps, self.small_buffer)
        return product(seed=range(self.seeds), task=TASKS, exploration_std=STDS, buffer=buffers)

    def rows(self, seed: int, task: str, exploration_std: float, buffer: int) -> Iterator[Row]:
        """What is learned, and what W says of it."""
        th.set_num_threads(1)
        model = NAF(
            "MlpPolicy", task, exploration_std=exploration_std, buffer_size=buffer, seed=seed, device="cpu"
        ).learn(self.steps)
        model.policy.set_training_mode(False)
        env = gym.make(task, max_episode_steps=LONG)
        seeds = range(EVALUATION_SEED, EVALUATION_SEED + self.episodes)
        found = [_judged(model, env, episode, exploration_std) for episode in seeds]
        means = {column: float(np.mean([one[column] for one in found])) for column in found[0]}
        yield {**means, "effective_share": _effective_share(model)}


FULL = Exploration()
QUICK = Exploration(steps=120, small_buffer=60, seeds=1, episodes=1)


def _judged(model: NAF, env: gym.Env, seed: int, std: float) -> Row:
    """W where an episode begins, and the discounted returns of mu there, alone and with noise."""
    observation, _ = env.reset(seed=seed)
    with th.no_grad():
        w = model.q_net.target_value(model.policy.obs_to_tensor(observation)[0]).item()
    return {"w": w, "of_mu": _discounted(model, env, seed, 0.0), "with_noise": _discounted(model, env, seed, std)}


def _discounted(model: NAF, env: gym.Env, seed: int, std: float) -> float:
    """Discounted return of an episode of mu with noise on scaled actions."""
    noise, found, discount, ended = np.random.default_rng(seed), 0.0, 1.0, False
    observation, _ = env.reset(seed=seed)
    while not ended:
        mu = model.policy.scale_action(model.predict(observation, deterministic=True)[0])
        action = model.policy.unscale_action(np.clip(mu + std * noise.standard_normal(mu.shape), -1.0, 1.0))
        observation, reward, terminated, truncated, _ = env.step(action)
        found += discount * float(reward)
        discount *= model.gamma
        ended = terminated or truncated
    return found


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
    """A row for each kind of training: means of its seeds."""
    found = rows.groupby(["task", "buffer", "exploration_std"], sort=True).mean().drop(columns="seed")
    seeds = rows.groupby(["task", "buffer", "exploration_std"], sort=True).size()
    return found.assign(seeds=[so_far(made, FULL.seeds) for made in seeds]).reset_index()


def answer(rows: DataFrame) -> str:
    """Where W is beside what mu earns, alone and with its noise: means of seeds, whatever noise and buffer."""
    if len(rows) < len(FULL.cases()):
        return "Trainings are missing so far to tell what W depends on."
    return " ".join(
        f"On {task} W is {_beside(of.w - of.of_mu)} the return of mu, and {_beside(of.w - of.with_noise)} that of mu "
        f"with its noise. Its weights leave {shown(of.effective_share.mean(), '.0%')} of a batch effective."
        for task, of in groups(_of_kinds(rows), "task").items()
    )


def _beside(differences: Series[float]) -> str:
    """How far something is above or below another, in words."""
    lowest, highest = differences.min(), differences.max()
    if lowest < 0 < highest:
        return f"from {shown(-lowest, '.0f')} below to {shown(highest, '.0f')} above"
    near, far = sorted((abs(lowest), abs(highest)))
    return f"{shown(near, '.0f')} to {shown(far, '.0f')} {'above' if lowest > 0 else 'below'}"


def values(rows: DataFrame) -> str:
    """W beside what mu earns, for each width of the noise and each buffer."""
    columns = ["task", "buffer", "exploration_std", "seeds", "w", "of_mu", "with_noise", "effective_share"]
    formats = {"exploration_std": ".1f", "w": ".1f", "of_mu": ".1f", "with_noise": ".1f", "effective_share": ".0%"}
    caption = (
        f"After {FULL.steps:,} steps: W where episodes begin, and the discounted return from there, of mu and of mu "
        "with its noise. Means of the seeds."
    )
    return table(_of_kinds(rows), columns, caption, **formats)
