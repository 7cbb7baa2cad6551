"""A task of your own: P1 to P3 are learned, and P4 and P5, which hardly matter, stay 1.

One sees what CMA-ES learned. Once the task has an entry in ``TASKS``, everything takes it by its name. A task for
the command line and for several workers stands in a file of the package; the tutorial shows how.
"""

import tempfile
from pathlib import Path

import sarah
from sarah.control.parameters import PAPER_STEPPING, STEPPING_PARAMETERS
from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.tasks import TASKS, Task
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder
from sarah.training.train import train


def controller_parameters(chosen, config):
    """P1 to P5, and no hip law."""
    return SteppingParameters(*chosen, 1.0, 1.0), None


TASKS["three"] = Task(
    name="three",
    title="Stepping with three parameters",
    parameters=STEPPING_PARAMETERS[:3],
    episode=sarah.EpisodeConfig(time_limit=6.0),
    controller_parameters=controller_parameters,
    baseline=PAPER_STEPPING[:3],
    baseline_label="the paper's parameters, simulated here",
)
config = TrainingConfig(task="three", algo="cma-es", episodes=16)
learned = train(config, RunFolder.create(Path(tempfile.mkdtemp()), config))
print(f"P1 to P3  {', '.join(f'{value:.2f}' for value in learned.parameters)}")
print(f"score     {learned.evaluation.median('score'):.3f} on unseen seeds")
