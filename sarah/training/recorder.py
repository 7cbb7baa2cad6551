"""The records of a training while it goes on: every episode, and the recommendation from time to time."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NoReturn

from stable_baselines3.common.logger import KVWriter, Logger
from tqdm import tqdm

from sarah.control.parameters import Parameters
from sarah.episode.evaluation import Evaluation
from sarah.episode.result import METRICS, EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.runs.recorded_episodes import RecordedEpisodes
from sarah.runs.run_folder import RunFolder
from sarah.training.learning_curves import LEARNED, CurveWriter, kept_pictures
from sarah.training.plan import Plan
from sarah.training.recommendation import Tried, merit

EPISODES_PER_RECOMMENDATION = 5
"""Number of episodes after which the recommendation is recorded again."""


class EpisodeRecorder(KVWriter):
    """Writes every episode to ``episodes.csv`` and to the learning curves.

    While a resumed training replays the episodes of its journal, nothing is written. When it goes on, all files are
    written anew, so that they are the same as without the interruption. Pictures that TensorBoard had are not drawn
    again.

    :param run: run folder of the training
    :param plan: plan of the training
    :param episodes: episodes of the training, with its journal
    :param progress: progress bar, which every episode moves on
    """

    log: Logger
    """Logger of the learning curves, which the agent uses as well."""
    tried: Tried
    """Parameters, merit and disturbances of every episode so far."""
    diverged: int
    """Number of episodes so far that diverged."""

    def __init__(self, run: RunFolder, plan: Plan, episodes: RecordedEpisodes, progress: tqdm[NoReturn]) -> None:
        self.log = Logger(folder=None, output_formats=[self])
        self.diverged = 0
        self._config = plan.config
        self._task = plan.config.task
        self._warm_up = plan.warm_up_episodes
        self.tried = Tried(self._task)
        self._run = run
        self._outside, self._journal = episodes.outside, episodes.journal
        self._progress = progress
        self._curves: CurveWriter | None = None
        self._kept = kept_pictures(run)  # before the old curves are removed

    def record(self, spec: EpisodeSpec, result: EpisodeResult, choice: Callable[[], Parameters] | None = None) -> None:
        """Write one episode, and from time to time what is recommended.

        :param spec: specification of the episode
        :param result: result of the episode
        :param choice: function that returns what the algorithm itself would choose now; ``None`` for a trial
        """
        index = len(self.tried)
        self._journal.hold(partial(self._append_episode, index, spec, result))
        worth = merit(result, self._task.must_step, spec.config.least_clearance)
        self.tried.append(spec.parameters, worth, disturbances_of(spec))
        self.diverged += result.termination == "diverged"
        x, y, _ = result.final_position
        self.log.record("train/return", result.episode_return)
        self.log.record("train/is_warm_up", int(index < self._warm_up))
        self.log.record("robot/x", x)
        self.log.record("robot/y", y)
        for name, metric in METRICS.items():
            if metric.group:
                self.log.record(f"{metric.group}/{name}", getattr(result, name))
        for name, value in zip(self._task.parameter_names, spec.parameters, strict=True):
            self.log.record(f"parameters/{name}", value)
        if choice is not None:
            self._record_recommendation(choice, len(self.tried))
        self.log.dump(len(self.tried))
        self._progress.set_postfix(score=f"{result.score:.2f}", refresh=False)
        self._progress.update()

    def _append_episode(self, index: int, spec: EpisodeSpec, result: EpisodeResult) -> None:
        self._open_curves()  # which removes the tables of before
        self._run.append_episode(index, spec, result)

    def _record_recommendation(self, choice: Callable[[], Parameters], episodes: int) -> None:
        """Record the recommendation, and draw it, after the numbers of episodes that are set for each."""
        interval = self._config.pictures
        noted = episodes % EPISODES_PER_RECOMMENDATION == 0
        drawn = episodes in self._kept or (interval and episodes % interval == 0)
        if not noted and not drawn:
            return
        recommended = self.tried.best(choice())
        if noted:
            named = dict(zip(self._task.parameter_names, recommended, strict=True))
            self._journal.hold(partial(self._run.append_recommendation, episodes, named))
            for name, value in named.items():
                self.log.record(f"recommendation/{name}", value, exclude="csv")  # recommendations.csv has it
        if drawn:
            self._journal.hold(partial(self._draw, recommended, episodes))

    def _draw(self, recommended: Parameters, episodes: int) -> None:
        if episodes in self._kept:
            summary = self._kept.pop(episodes)
        else:
            from sarah.pictures.gait_snapshot import draw_gait  # slow to import because of matplotlib

            with self._outside():
                summary = draw_gait(recommended, self._config.task, self._config.episode)
        self._open_curves().show(summary, episodes)

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Write a point of each learning curve, as an output of the logger.

        :param key_values: values by name of the curve
        :param key_excluded: formats that leave a curve out, by name of the curve
        :param step: number of episodes so far
        """
        values, excluded = dict(key_values), dict(key_excluded)  # the logger empties both when this returns
        self._journal.hold(lambda: self._open_curves().write(values, excluded, step))

    def close(self) -> None:
        """Close the learning curves, also of a training that failed."""
        if self._curves is not None:
            self._curves.close()

    def finish(self, learned: Evaluation) -> None:
        """Write the final values of the training and all records that are held back.

        :param learned: evaluation of the learned parameters on unseen seeds
        """
        values = (
            learned.mean("score"),
            learned.mean("steps_per_second"),
            learned.survival_rate,
            learned.mean("sole_clearance"),
        )
        self.write(dict(zip(LEARNED, values, strict=True)), dict.fromkeys(LEARNED, ("csv",)), len(self.tried))
        self._journal.release()

    def _open_curves(self) -> CurveWriter:
        if self._curves is None:
            self._run.remove_records()
            self._curves = CurveWriter(self._run)
        return self._curves
