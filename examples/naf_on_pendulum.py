"""NAF on an environment that has nothing to do with the robot: ``python naf_on_pendulum.py [STEPS]``.

One sees the mean return of the same ten episodes before and after learning. The few steps of the default only show the
way; give it 5000, half a minute, and the pendulum stands up.
"""

import sys

import gymnasium
import torch
from stable_baselines3.common.evaluation import evaluate_policy
from stable_baselines3.common.monitor import Monitor

from sarah.agents import NAF

torch.set_num_threads(1)  # the networks are small: more threads only wait for each other
steps = int(sys.argv[1]) if len(sys.argv) > 1 else 600
model = NAF("MlpPolicy", "Pendulum-v1", seed=0)
for learned in (0, steps):
    if learned:
        model.learn(learned)
    env = Monitor(gymnasium.make("Pendulum-v1"))
    env.reset(seed=1)
    print(f"after {learned:5} steps: mean return {evaluate_policy(model, env)[0]:.0f}")
