"""Whether parameters that follow the ground do better than one set for all grounds.

A controller chooses V1 to V4 once an episode, after the robot has stood for a second: the same ones whatever the ground
is, or by what the robot felt. Two sets of grounds are asked. On the ordinary ones the shipped controller copes anyway.
The others are a positive control, where the method has to see a gain: on either of two slopes the robot takes V1 for
another value, lower on the one and higher on the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from pathlib import Path
from statistics import mean
from typing import Any

import gymnasium
import numpy as np

from experiments.conditions import LEARNED
from experiments.maker import ParallelExperiment
from experiments.interval import with_interval
from experiments.record import Row
from experiments.trainings import identity, kept
from sarah.envs.sarah_env import SarahEnv, observation_from, parameters_from
from sarah.episode.episode import Episode
from sarah.episode.push import Push
from sarah.episode.spec import FIRST_EVALUATION_SEED, FIRST_TRAINING_SEED
from sarah.episode.tasks import BALANCE, BalanceConfig, Task
from sarah.episode.workers import Workers
from sarah.simulation.terrain import Terrain


@dataclass(frozen=True)
class Ground:
    """Ground that a controller has to cope with.

    :param terrain: slope, bumps and friction
    :param push_newtons: force of the push, in N
    :param V1_error: what the robot adds to the V1 that a controller chose
    :param time_limit: time limit of an episode, in s
    """

    terrain: Terrain = Terrain()
    push_newtons: float = 75.0
    V1_error: float = 0.0
    time_limit: float = 8.0

    @property
    def config(self) -> BalanceConfig:
        """Settings of the episodes."""
        push = Push((self.push_newtons, self.push_newtons), at_seconds=(2.0, 3.0))
        return BALANCE.config_of(
            LEARNED.config, engine="mujoco", time_limit=self.time_limit, push=push, terrain=self.terrain
        )

    @property
    def task(self) -> Task[BalanceConfig]:
        """Second Training, whose range of V1 is moved by the error."""
        first, *others = BALANCE.parameters
        moved = replace(first, low=first.low + self.V1_error, high=first.high + self.V1_error)
        baseline, neutral = self.with_error(BALANCE.baseline), self.with_error(BALANCE.neutral)
        return replace(BALANCE, parameters=(moved, *others), baseline=baseline, neutral=neutral)

    def with_error(self, parameters: tuple[float, ...]) -> tuple[float, ...]:
        """V1 to V4 as the robot takes them.

        :param parameters: V1 to V4 that a controller chose
        """
        first, *others = parameters
        return (first + self.V1_error, *others)


def slope(degrees: float, uphill: float) -> Terrain:
    """Slope in one direction.

    :param degrees: slope, in degrees
    :param uphill: direction that leads uphill, in degrees
    """
    return Terrain(slope_degrees=(degrees, degrees), direction_degrees=(uphill, uphill))


GROUNDS: dict[str, dict[str, Ground]] = {
    "ordinary": {
        "level": Ground(),
        "6° uphill right": Ground(slope(6.0, 0.0)),
        "6° uphill left": Ground(slope(6.0, 180.0)),
        "8° uphill forward": Ground(slope(8.0, 90.0)),
        "bumps of 10 mm": Ground(Terrain(roughness=(0.01, 0.01))),
        "friction 0.15": Ground(Terrain(friction_left=(0.15, 0.15), friction_right=(0.15, 0.15))),
    },
    "opposed": {
        "6° uphill right": Ground(slope(6.0, 0.0), push_newtons=0.0, V1_error=-1.0),
        "6° uphill left": Ground(slope(6.0, 180.0), push_newtons=0.0, V1_error=2.0),
    },
}
"""Grounds by name, of each set."""
SHIPPED, ONE_SET, PER_GROUND = "shipped parameters", "one set (CMA-ES)", "a set for each ground (CMA-ES)"
BLIND, SEEING = "NAF, blind", "NAF with observations"
CONTROLLERS = (SHIPPED, ONE_SET, PER_GROUND, BLIND, SEEING)
Policy = Callable[[str, np.ndarray], tuple[float, ...]]
"""Function that chooses V1 to V4 on a ground, by its name and by what the robot feels."""


@dataclass(frozen=True)
class Contexts(ParallelExperiment):
    """Controllers that choose V1 to V4 for all grounds alike, for each ground, or by what the robot feels.

    :param seeds: number of trainings of each controller
    :param budget: number of episodes of a training for each ground
    :param episodes: number of episodes on each ground that judge a training
    :param time_limit: time limit of an episode, in s
    :param runs: folder that keeps what trainings score; one that is there is not run again
    """

    seeds: int = 4
    budget: int = 240
    episodes: int = 60
    time_limit: float = 8.0
    runs: Path = Path("runs/experiments")

    def rows(self) -> Iterator[Row]:
        """A row for each set of grounds, controller and ground, and one for all grounds."""
        with Workers(self.workers) as workers:
            jobs = {
                (of, controller): [
                    workers.submit(kept, self._file(of, controller, seed), judge, self, of, controller, seed)
                    for seed in range(self.seeds)
                ]
                for of in GROUNDS
                for controller in CONTROLLERS
            }
            for of, grounds in GROUNDS.items():
                judged = {controller: [job.result() for job in jobs[of, controller]] for controller in CONTROLLERS}
                for controller in CONTROLLERS:
                    for ground in (*grounds, "all"):
                        scores, best = (means(judged[name], ground) for name in (controller, ONE_SET))
                        yield {
                            "grounds": of,
                            "controller": controller,
                            "ground": ground,
                            "trainings": self.seeds,
                            "episodes": self.episodes * (len(grounds) if ground == "all" else 1) * self.seeds,
                            **with_interval("score", scores),
                            **with_interval("gain", [own - one for own, one in zip(scores, best, strict=True)]),
                        }

    def _file(self, of: str, controller: str, seed: int) -> Path:
        name = identity((self.budget, self.episodes, self.grounds(of), controller, seed))
        return self.runs / "contexts" / f"{name}.json"

    def grounds(self, of: str) -> dict[str, Ground]:
        """Grounds by name.

        :param of: name of their set
        """
        return {name: replace(ground, time_limit=self.time_limit) for name, ground in GROUNDS[of].items()}


def means(judged: list[dict[str, list[float]]], ground: str) -> list[float]:
    """Mean score of each training on a ground.

    :param judged: scores by ground, of each training
    :param ground: name of the ground, or ``all``
    """
    return [mean(scores[ground] if ground in scores else chain(*scores.values())) for scores in judged]


def judge(options: Contexts, of: str, controller: str, seed: int) -> dict[str, list[float]]:
    """Train a controller, and let it run on fresh seeds, which are the same for all controllers of one seed.

    :param options: size of training and evaluation
    :param of: name of the set of grounds
    :param controller: one of :data:`CONTROLLERS`
    :param seed: seed of the training
    :return: scores by ground
    """
    policy = learn(options, of, controller, seed)
    first = FIRST_EVALUATION_SEED + seed * options.episodes
    return {
        name: [run(ground, first + index, partial(policy, name)) for index in range(options.episodes)]
        for name, ground in options.grounds(of).items()
    }


def run(ground: Ground, seed: int, choose: Callable[[np.ndarray], tuple[float, ...]]) -> float:
    """Simulate an episode whose parameters depend on what the robot feels while it stands.

    :param ground: ground of the episode
    :param seed: seed of the episode
    :param choose: function that chooses V1 to V4
    :return: the score
    """
    with Episode(ground.config, seed, ground.task) as episode:
        return episode.run(ground.with_error(choose(observation_from(episode.stand(), ground.config.scale)))).score


def learn(options: Contexts, of: str, controller: str, seed: int) -> Policy:
    """Train a controller.

    :param options: size of the training
    :param of: name of the set of grounds
    :param controller: one of :data:`CONTROLLERS`
    :param seed: seed of the training
    """
    grounds = options.grounds(of)
    budget = options.budget * len(grounds)
    if controller == SHIPPED:
        return lambda ground, felt: LEARNED.parameters
    if controller == ONE_SET:
        parameters = evolve(list(grounds.values()), budget, seed)
        return lambda ground, felt: parameters
    if controller == PER_GROUND:
        own = {name: evolve([ground], options.budget, seed) for name, ground in grounds.items()}
        return lambda ground, felt: own[ground]
    return train_naf(list(grounds.values()), budget, seed, is_blind=controller == BLIND)


def evolve(grounds: list[Ground], budget: int, seed: int) -> tuple[float, ...]:
    """Find one set for some grounds by CMA-ES, which is told the mean score on all of them.

    :param grounds: grounds of the episodes
    :param budget: number of episodes
    :param seed: seed of the draws and of the episodes
    """
    import cma

    episodes = np.random.default_rng(seed)
    options = {"bounds": [-1.0, 1.0], "seed": seed + 1, "verbose": -9}
    strategy = cma.CMAEvolutionStrategy(_action_of(LEARNED.parameters), 0.3, options)
    while budget >= strategy.popsize * len(grounds):
        asked = strategy.ask()
        losses = []
        for action in asked:
            parameters = parameters_from(np.clip(action, -1.0, 1.0), BALANCE)
            seeds = episodes.integers(FIRST_TRAINING_SEED, 2**32, len(grounds)).tolist()
            losses.append(
                -mean(run(*episode, partial(_always, parameters)) for episode in zip(grounds, seeds, strict=True))
            )
        strategy.tell(asked, losses)
        budget -= strategy.popsize * len(grounds)
    return parameters_from(np.clip(strategy.mean, -1.0, 1.0), BALANCE)


def _always(parameters: tuple[float, ...], felt: np.ndarray) -> tuple[float, ...]:
    return parameters


def _action_of(parameters: tuple[float, ...]) -> np.ndarray:
    """Action that stands for parameters."""
    return np.array(BALANCE.box.scaled(parameters))


def train_naf(grounds: list[Ground], budget: int, seed: int, is_blind: bool) -> Policy:
    """Let NAF learn which parameters suit what the robot feels.

    :param grounds: grounds, of which each episode draws one
    :param budget: number of episodes
    :param seed: seed of the training
    :param is_blind: whether all observations are zero
    """
    from stable_baselines3.common.utils import LinearSchedule

    from sarah.agents import NAF, PRESETS

    model = NAF(
        "MlpPolicy",
        DrawnGround(grounds, is_blind),
        seed=seed,
        gamma=0.0,
        learning_starts=min(60, budget // 2),
        batch_size=64,
        gradient_steps=10,
        exploration_std=LinearSchedule(0.4, 0.1, end_fraction=0.8),
        policy_kwargs=PRESETS["one-step"]["policy_kwargs"],
    )
    model.learn(budget)

    def policy(ground: str, felt: np.ndarray) -> tuple[float, ...]:
        action, _ = model.predict(np.zeros_like(felt) if is_blind else felt, deterministic=True)
        return parameters_from(action, BALANCE)

    return policy


class DrawnGround(gymnasium.Wrapper[np.ndarray, np.ndarray, np.ndarray, np.ndarray]):
    """Episodes on one of several grounds, drawn at each reset; the reward is the score.

    :param grounds: the grounds
    :param is_blind: whether all observations are zero
    """

    def __init__(self, grounds: list[Ground], is_blind: bool) -> None:
        self._all = [SarahEnv(ground.task, ground.config) for ground in grounds]
        self._is_blind = is_blind
        super().__init__(self._all[0])

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[np.ndarray, dict[str, Any]]:
        """Draw a ground, and stand on it.

        :param seed: seed of the draws
        :param options: options of gymnasium, which are ignored
        """
        if seed is not None:
            for index, env in enumerate(self._all):
                env.reset(seed=seed + index)
            self._draws = np.random.default_rng(seed)
        self.env = self._all[self._draws.integers(len(self._all))]
        observation, info = self.env.reset()
        return self._seen(observation), info

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        """Run the episode.

        :param action: V1 to V4, scaled to [-1, 1]
        """
        observation, _, terminated, truncated, info = self.env.step(action)
        return self._seen(observation), info["result"].score, terminated, truncated, info

    def _seen(self, observation: np.ndarray) -> np.ndarray:
        return np.zeros_like(observation) if self._is_blind else observation
