"""What a run folder says of a training, read once."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

from sarah.episode.evaluation import Evaluation, NotedEvaluation
from sarah.episode.result import METRICS
from sarah.errors import RunFolderError
from sarah.number import is_finite, number
from sarah.recorded.folder import LONGEST_REASON
from sarah.runs.config import TrainingConfig
from sarah.runs.run_folder import RunFolder, read_result

Rows = tuple[dict[str, str], ...]


@dataclass(frozen=True)
class RunRecord:
    """A training as its run folder has it. Each file is read when it is first asked for, and not again.

    :param folder: run folder of the training
    """

    folder: RunFolder

    @cached_property
    def config(self) -> TrainingConfig:
        """Settings of the training."""
        return self.folder.config()

    @cached_property
    def learned(self) -> tuple[float, ...]:
        """Learned parameters, in the order of the task."""
        return self.folder.parameters(self.config)

    @cached_property
    def episodes(self) -> Rows:
        """Rows of ``episodes.csv``, as text."""
        return tuple(self.folder.episodes(self.config))

    @cached_property
    def recommendations(self) -> Rows:
        """Rows of ``recommendations.csv``, as text."""
        return tuple(self.folder.recommendations(self.config))

    def evaluation(self, name: str, episodes: int) -> Evaluation | None:
        """Evaluation with which the training ended, on the first seeds; none if its result has none like that.

        :param name: ``evaluation``, that of the learned parameters, or ``baseline``, that of the neutral ones
        :param episodes: number of episodes
        """
        noted = read_result(self.folder.result_path).get(name)
        names = [f"{metric}_{statistic}" for metric in METRICS for statistic in METRICS[metric].statistics]
        if not isinstance(noted, dict) or noted.get("episodes") != episodes:
            return None
        if not all(is_finite(noted.get(one)) for one in ("survival_rate", "diverged", *names)):
            return None
        return NotedEvaluation((), self.config.episode.least_clearance, noted=noted)

    @contextmanager
    def naming_folder(self) -> Iterator[None]:
        """Context in which rows are read: an error names the folder.

        :raises RunFolderError: if a row lacks a column, or has no number where one belongs
        """
        try:
            yield
        except (KeyError, TypeError, ValueError) as error:
            reason = repr(error)[:LONGEST_REASON]
            raise RunFolderError(f"the episodes of {self.folder.path} cannot be read: {reason}") from error

    def columns(self, rows: Rows, names: Sequence[str]) -> dict[str, list[float]]:
        """Columns of one of the tables, as numbers.

        :param rows: rows of the table
        :param names: names of the columns
        :raises RunFolderError: if a column is missing, or has something else than numbers
        """
        with self.naming_folder():
            return {name: [number(row[name]) for row in rows] for name in names}
