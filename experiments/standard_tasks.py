"""NAF on standard tasks, against stable-baselines3's TD3, SAC and DDPG: mean return of evaluation episodes at the end.

Everybody runs with the defaults of its class; TD3 and DDPG with the Gaussian noise that their documentation adds.
"""

from __future__ import annotations

import argparse
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from statistics import median

import gymnasium as gym
import numpy as np
import torch
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.noise import NormalActionNoise

from sarah.agents import NAF

ALGORITHMS = {"naf": NAF, "td3": TD3, "sac": SAC, "ddpg": DDPG}
EVALUATION_SEED = 10_000


def evaluated(task: str, algo: str, seed: int, steps: int, episodes: int) -> float:
    """Train, and return the mean return of evaluation episodes, the same for every algorithm and seed."""
    torch.set_num_threads(1)
    env = gym.make(task)
    settings = {}
    if algo in ("td3", "ddpg"):
        dimensions = env.action_space.shape[0]
        settings["action_noise"] = NormalActionNoise(np.zeros(dimensions), np.full(dimensions, 0.1))
    model = ALGORITHMS[algo]("MlpPolicy", env, seed=seed, device="cpu", **settings).learn(steps)
    judged = Monitor(gym.make(task))
    judged.reset(seed=EVALUATION_SEED)
    return float(evaluate_policy(model, judged, episodes)[0])


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--task", default="Pendulum-v1")
    parser.add_argument("--algorithms", nargs="+", default=list(ALGORITHMS), choices=ALGORITHMS)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--steps", type=int, default=10_000)
    parser.add_argument("--episodes", type=int, default=20, help="of each evaluation")
    parser.add_argument("--processes", type=int, default=2)
    options = parser.parse_args()
    print(f"| {options.task}, {options.steps} steps | median return | lowest seed | highest seed |\n|---|---|---|---|")
    with ProcessPoolExecutor(options.processes, get_context("spawn")) as pool:
        jobs = {
            algo: [
                pool.submit(evaluated, options.task, algo, seed, options.steps, options.episodes)
                for seed in range(options.seeds)
            ]
            for algo in options.algorithms
        }
        for algo, running in jobs.items():
            returns = [job.result() for job in running]
            print(f"| {algo} | {median(returns):.1f} | {min(returns):.1f} | {max(returns):.1f} |", flush=True)


if __name__ == "__main__":
    main()
