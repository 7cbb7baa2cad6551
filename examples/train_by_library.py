"""A training without the command line: ``python train_by_library.py [RUN_FOLDER]``.

One sees what NAF learned. The run folder, a temporary one unless it is given, holds what ``sarah-train`` would write.
So few episodes only show the way; a hundred of the full length make a robot that steps.
"""

import sys
import tempfile
from pathlib import Path

import sarah
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train

path = Path(sys.argv[1] if len(sys.argv) > 1 else tempfile.mkdtemp())
episode = sarah.EpisodeConfig(time_limit=3.0)
config = TrainingConfig(task="stepping", algo="naf", episodes=12, seed=0, episode=episode)
learned = train(config, RunFolder.create(path, config))
print(f"P1 to P5    {', '.join(f'{value:.2f}' for value in learned.parameters)}")
print(f"score       {learned.evaluation.mean('score'):.3f} on unseen seeds")
print(f"run folder  {path}")
