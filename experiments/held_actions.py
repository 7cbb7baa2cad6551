"""What an action decides on Hopper where NAF stays, and what the values of NAF and DDPG make of it."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from statistics import median
from typing import Any, NamedTuple

import gymnasium as gym
import numpy as np
import torch as th
from stable_baselines3 import DDPG
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm

from experiments.maker import ParallelExperiment
from experiments.record import Row
from experiments.several_actions import EVALUATION_SEED, model
from sarah.agents import NAF
from sarah.episode.workers import Workers

TASK = "Hopper-v5"
HORIZON = 500
"""Number of steps after which the rest of a discounted return counts for less than a hundredth."""


class Moment(NamedTuple):
    """The simulator's state at a step of an episode.

    :param positions: of the joints, in m and rad
    :param speeds: of the joints, in m/s and rad/s
    """

    positions: np.ndarray
    speeds: np.ndarray


@dataclass(frozen=True)
class HeldActions(ParallelExperiment):
    """A random action is held for some steps of an episode of mu; then mu goes on.

    :param steps: number of steps of a training
    :param seeds: number of trainings of each algorithm
    :param every: number of steps between the moments at which actions are held
    :param draws: number of random actions at each moment
    :param held_steps: numbers of steps for which they are held
    """

    steps: int = 30_000
    seeds: int = 2
    every: int = 6
    draws: int = 10
    held_steps: tuple[int, ...] = (1, 5, 15)

    def rows(self) -> Iterator[Row]:
        """A row for each algorithm and number of steps for which an action is held."""
        with Workers(self.workers) as workers:
            jobs = {
                algorithm: [workers.submit(changes, algorithm, seed, self) for seed in range(self.seeds)]
                for algorithm in ("naf", "ddpg")
            }
            for algorithm, running in jobs.items():
                of_seeds = [job.result() for job in running]
                for index, held in enumerate(self.held_steps):
                    found = [true_and_said[index] for true_and_said in of_seeds]
                    yield {
                        "algorithm": algorithm,
                        "held_steps": held,
                        "seeds": self.seeds,
                        **{column: median(function(*one) for one in found) for column, function in COLUMNS.items()},
                    }


COLUMNS: dict[str, Callable[[np.ndarray, np.ndarray], float]] = {
    "mean_true_change": lambda true, said: float(true.mean()),
    "std_of_true_change": lambda true, said: float(true.std()),
    "best_true_change": lambda true, said: float(true.max()),
    "std_of_error": lambda true, said: float((said - true).std()),
    "correlation": lambda true, said: float(np.corrcoef(true, said)[0, 1]),
}
"""Statistics of the true changes of the return, and of those that the values say."""


def changes(algorithm: str, seed: int, of: HeldActions) -> list[tuple[np.ndarray, np.ndarray]]:
    """Changes of the discounted return by held actions, true ones and those that the values say, for each length.

    :param algorithm: name of the algorithm
    :param seed: seed of its training
    :param of: sizes
    """
    th.set_num_threads(1)
    agent = model(algorithm, gym.make(TASK), seed).learn(of.steps)
    agent.policy.set_training_mode(False)
    env: Any = gym.make(TASK).unwrapped
    moments = episode(agent, env)[:: of.every]
    generator = np.random.default_rng(seed)
    found = []
    for held in of.held_steps:
        true, said = [], []
        for moment in moments:
            own = returns(agent, env, moment, None, held)
            for action in generator.uniform(-1.0, 1.0, (of.draws, env.action_space.shape[0])):
                other = returns(agent, env, moment, action, held)
                true.append(other[0] - own[0])
                said.append(other[1] - own[1])
        found.append((np.array(true), np.array(said)))
    return found


def episode(agent: OffPolicyAlgorithm, env: Any) -> list[Moment]:
    """The moments of an episode without exploration.

    :param agent: agent that acts
    :param env: its environment, without a time limit
    """
    observation, _ = env.reset(seed=EVALUATION_SEED)
    moments, terminated = [], False
    while not terminated and len(moments) < HORIZON:
        moments.append(Moment(env.data.qpos.copy(), env.data.qvel.copy()))
        observation, _, terminated, _, _ = env.step(best_action(agent, observation))
    return moments


def returns(
    agent: OffPolicyAlgorithm, env: Any, moment: Moment, action: np.ndarray | None, held_steps: int
) -> tuple[float, float]:
    """Discounted return from a moment on, and what it would be if the value after the held action were right.

    :param agent: agent that acts after the held action
    :param env: its environment, without a time limit
    :param moment: where to begin
    :param action: action to hold; by default those of the agent
    :param held_steps: number of steps for which it is held
    """
    env.set_state(*moment)
    observation = env._get_obs()
    true = said = 0.0
    for step in range(HORIZON):
        if step == held_steps:
            said = true + agent.gamma**step * value(agent, observation)
        holds = action is not None and step < held_steps
        observation, reward, terminated, _, _ = env.step(action if holds else best_action(agent, observation))
        true += agent.gamma**step * reward
        if terminated:
            return true, said if step >= held_steps else true
    return true, said


def best_action(agent: OffPolicyAlgorithm, observation: np.ndarray) -> np.ndarray:
    """The agent's action without exploration.

    :param agent: the agent
    :param observation: an observation
    """
    return agent.predict(observation, deterministic=True)[0]


def value(agent: OffPolicyAlgorithm, observation: np.ndarray) -> float:
    """What targets take of a state: NAF's W, or DDPG's Q of its action.

    :param agent: the agent
    :param observation: an observation
    """
    observations = th.as_tensor(observation[None], dtype=th.float32)
    with th.no_grad():
        if isinstance(agent, NAF):
            return agent.q_net_target.target_value(observations).item()
        assert isinstance(agent, DDPG)
        return agent.critic_target(observations, agent.actor_target(observations))[0].item()
