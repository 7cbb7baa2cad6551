"""What is each part of NAF's preset for episodes of one step worth?

The task is a stand-in that costs nothing: five numbers, a reward with noise, a hill with its top beside a cliff, and a
lower, wider hill elsewhere, both in other places for every seed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import gymnasium as gym
import numpy as np
import torch
from gymnasium import spaces
from pandas import DataFrame

from experiments.experiment import Experiment, product
from experiments.record import Row
from experiments.tables import shown, table
from sarah.agents import NAF, PRESETS, LocalNAF, RankReplayBuffer

NOISE = 0.03
"""Standard deviation of the reward; the top of the hill is 1."""
CHECK_EVERY = 5
"""Number of episodes between checks of mu."""
HELD = 3
"""Number of checks in a row at which a score counts as reached."""
ONE_STEP, PAPER = PRESETS["one-step"], PRESETS["paper"]
NETWORKS = ONE_STEP["policy_kwargs"]
PARTS: dict[str, dict[str, Any]] = {
    "the preset": {},
    "rewards as they came": {"replay_buffer_class": RankReplayBuffer},
    "good and bad drawn alike": {"replay_buffer_kwargs": {"temperature": 0.0}},
    "Q may be flat": {"policy_kwargs": {**NETWORKS, "min_curvature": 0.0}},
    "mu and L share their layers": {
        "policy_kwargs": {**NETWORKS, "net_arch": dict(V=[32, 32], shared=[32, 32], mu=[], L=[])}
    },
    "ReLU instead of tanh": {"policy_kwargs": {**NETWORKS, "activation_fn": torch.nn.ReLU}},
    "noise stays at 0.3": {"exploration_std": 0.3},
    "nothing explored around the best": {"elite_share": 0.0},
    "all explored around the best": {"elite_share": 1.0},
    "the most promising of 16 draws": {"elite_draws": 16},
    "warm-up of 30": {"learning_starts": 30},
    "one update per episode": {"gradient_steps": 1},
    "20 updates per episode": {"gradient_steps": 20},
}
"""The preset, and the preset with one part changed."""
TANH = {"policy_kwargs": {**PAPER["policy_kwargs"], "activation_fn": torch.nn.Tanh}}
EFFORT = {"gamma": 0.0, **{name: ONE_STEP[name] for name in ("gradient_steps", "learning_starts", "batch_size")}}
"""What the preset spends on learning, for those that are not the preset."""
OTHERS: dict[str, dict[str, Any]] = {
    "NAF's defaults": {},
    "NAF's defaults, with V": {"policy_kwargs": {"net_arch": dict(V=[256, 256], shared=[256, 256], mu=[], L=[])}},
    "the paper's preset": PAPER,
    "the paper's preset with tanh": TANH,
    "the one-step preset with the paper's networks": {**ONE_STEP, **PAPER},
    "the same with tanh": {**ONE_STEP, **TANH},
}
SETTINGS = {name: {**ONE_STEP, **part} for name, part in PARTS.items()} | {
    name: {**EFFORT, **other} for name, other in OTHERS.items()
}
COUNTS, SCORES = ("episodes_to_80", "episodes_to_90"), ("mu_score", "best_action_score")


class Hills(gym.Env):
    """A hill beside a cliff, and a decoy.

    :param seed: seed of their places, and of the noise
    """

    observation_space = spaces.Box(-1.0, 1.0, (16,))
    action_space = spaces.Box(-1.0, 1.0, (5,))

    def __init__(self, seed: int) -> None:
        self._generator = np.random.default_rng(seed)
        self._top = self._generator.uniform(-0.6, 0.6, 5)
        self._decoy = -np.sign(self._top) * self._generator.uniform(0.3, 0.7, 5)

    def score(self, action: np.ndarray) -> float:
        """Mean reward of an action."""
        from_top, from_decoy = action - self._top, action - self._decoy
        hill = np.exp(-3.0 * from_top @ from_top) if from_top[0] < 0.15 else 0.0
        return float(max(hill, 0.6 * np.exp(-1.5 * from_decoy @ from_decoy)))

    def _observe(self) -> np.ndarray:
        return self._generator.normal(0.0, 0.1, 16).clip(-1, 1).astype(np.float32)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Stand."""
        super().reset(seed=seed)
        return self._observe(), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """The whole episode."""
        reward = self.score(action.astype(float)) + self._generator.normal(0.0, NOISE)
        return self._observe(), reward, True, False, {}


@dataclass(frozen=True)
class NafPreset(Experiment):
    """Variants of NAF's preset on a stand-in for the robot.

    :param seeds: number of trainings of each variant
    :param episodes: number of episodes of a training
    """

    depends_on: ClassVar[tuple[str, ...]] = ("agents",)
    seeds: int = 8
    episodes: int = 200

    def cases(self) -> list[Row]:
        """Each training."""
        return product(variant=SETTINGS, seed=range(self.seeds))

    def rows(self, variant: str, seed: int) -> Iterator[Row]:
        """Scores of the agent's own action, and of the best one of its replay buffer, if that knows one.

        :param variant: name of the variant
        :param seed: seed of the training
        """
        torch.set_num_threads(1)
        env, settings, scores = Hills(seed), SETTINGS[variant], []
        algorithm = LocalNAF if "elite_share" in settings else NAF
        model = algorithm("MlpPolicy", env, seed=seed, **settings)

        def check(*_: Any) -> bool:
            if model.num_timesteps % CHECK_EVERY == 0:
                action = model.predict(np.zeros(16, np.float32), deterministic=True)[0]
                scores.append(env.score(action.astype(float)))
            return True

        model.learn(self.episodes, callback=check)
        knows = isinstance(model.replay_buffer, RankReplayBuffer)
        yield {
            **{f"episodes_to_{share}": episodes_until(scores, share / 100) for share in (80, 90)},
            "mu_score": scores[-1],
            "best_action_score": env.score(model.replay_buffer.best_action().astype(float)) if knows else None,
        }


def episodes_until(scores: list[float], score: float) -> float:
    """Number of episodes until a score is reached and held; infinite if it never is.

    :param scores: scores along a training
    :param score: score to reach
    """
    for index in range(len(scores) - HELD + 1):
        if min(scores[index : index + HELD]) >= score:
            return float(CHECK_EVERY * (index + 1))
    return float("inf")


FULL = NafPreset()
QUICK = NafPreset(seeds=1, episodes=5)


def medians(rows: DataFrame) -> DataFrame:
    """Medians of the seeds by variant.

    :param rows: of the result
    """
    return rows.groupby("variant", sort=False)[[*COUNTS, *SCORES]].median()


def answer(rows: DataFrame) -> str:
    """Which parts matter."""
    counts = medians(rows)["episodes_to_80"]
    preset, defaults = counts["the preset"], counts["NAF's defaults"]
    first, second = counts.drop(list(OTHERS)).nlargest(2).index
    return (
        f"The agent's own action reaches 80 % of the top after {shown(preset, '.0f')} episodes in the median. Two "
        f"changes delay it most: {first} ({shown(counts[first], '.0f')} episodes), and {second} "
        f"({shown(counts[second], '.0f')}). NAF's defaults take {shown(defaults, '.0f')}."
    )


def variants(rows: DataFrame) -> str:
    """What each variant reaches."""
    formats = dict.fromkeys(COUNTS, ".0f") | dict.fromkeys(SCORES, ".2f")
    caption = (
        f"Episodes until mu reaches 80 and 90 % of the top and holds it, and scores after {FULL.episodes} episodes: "
        f"medians of {FULL.seeds} seeds."
    )
    return table(medians(rows).reset_index(), ["variant", *COUNTS, *SCORES], formats, caption)
