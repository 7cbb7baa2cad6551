"""A task of your own: equation 2, less what the actuators' power costs, on a robot that is pushed.

One sees what random search finds. The same file is for the command line: ``sarah-train --task own_task.py:THRIFTY``.
"""

import dataclasses
import tempfile
from pathlib import Path

import sarah

POWER_COST = 0.001
"""Loss of reward per second and watt."""


def reward(tick: sarah.Tick, config: sarah.EpisodeConfig) -> float:
    """Reward per second at the end of a control tick."""
    return sarah.equation_2(tick, config) - POWER_COST * tick.power


THRIFTY = dataclasses.replace(
    sarah.STEPPING,
    name="thrifty",
    title="Stepping that costs little power",
    episode=sarah.PushedConfig(time_limit=6.0, push=sarah.Push(newtons=30)),
    reward=reward,
)

if __name__ == "__main__":
    from sarah.runs.config import TrainingConfig
    from sarah.runs.run_folder import RunFolder
    from sarah.training.train import train

    config = TrainingConfig(task=sarah.load_task(f"{__file__}:THRIFTY"), algo="random", episodes=8)
    learned = train(config, RunFolder.create(Path(tempfile.mkdtemp()), config))
    print(f"P1 to P5  {', '.join(f'{value:.2f}' for value in learned.parameters)}")
    print(f"power     {learned.evaluation.mean('actuator_power'):.0f} W")
