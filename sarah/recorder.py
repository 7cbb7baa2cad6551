"""What a training leaves behind while it runs: every simulation, and what would be chosen at the time."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger

from sarah.recommendation import Parameters, merit
from sarah.runs import RunFolder
from sarah.tasks import Task

LOGGED_FIELDS = (
    "score",
    "steps_per_second",
    "duration",
    "event_driven_shift",
    "event_driven_lift",
    "sole_clearance",
    "vibration",
    "actuator_power",
)
"""Fields of a result that are logged under their own names."""
SIMULATIONS_PER_CHOICE = 5
"""How often it is noted what would be chosen."""


class EpisodeRecorder(BaseCallback):
    """Writes every simulation to ``episodes.csv`` and to the logger.

    :param run: where to
    :param task: whose parameters they are
    :param log: where to as well
    """

    tried: list[tuple[Parameters, float]]
    """Parameters and merit of every simulation so far."""
    choose: Callable[[], Parameters] | None
    """Tells what would be chosen now; while there is such a thing, it is noted in ``choices.csv``."""

    def __init__(self, run: RunFolder, task: Task, log: Logger) -> None:
        super().__init__()
        self.log = log
        self.tried = []
        self.choose = None
        self._names = task.parameter_names
        self._run = run

    def _on_step(self) -> bool:
        for info in self.locals["infos"]:
            if info:  # the first steps only fill the slots
                self.record(info)
        return True

    def record(self, info: dict[str, Any]) -> None:
        """Write one simulation.

        :param info: what the environment's step returned
        """
        self._run.append_episode(len(self.tried), self._names, info)
        self.tried.append((info["parameters"], merit(info)))
        x, y, _ = info["final_position"]
        shown = {"return": info["episode_return"], "x": x, "y": y, **{name: info[name] for name in LOGGED_FIELDS}}
        for name, value in shown.items():
            self.log.record(f"episode/{name}", value)
        for name, value in zip(self._names, info["parameters"], strict=True):
            self.log.record(f"parameters/{name}", value)
        self.log.dump(len(self.tried))
        if self.choose is not None and len(self.tried) % SIMULATIONS_PER_CHOICE == 0:
            self._run.append_choice(len(self.tried), self._names, self.choose())
