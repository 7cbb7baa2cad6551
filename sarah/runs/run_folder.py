"""The run folder: only this module knows its layout.

    config.yaml  command.txt  versions.txt     the settings, the command and the versions of the training
    task.py  task.json                         the task, if it is that of a file of the user's
    journal.jsonl                              the outcome of every episode in full, from which a training is resumed
    episodes.csv                               one row per episode; any row can be simulated again
    recommendations.csv                        the recommendation after every five episodes
    progress.csv  events.out.tfevents.*        the learning curves, for tables and for TensorBoard
    model.zip                                  the agent, in stable-baselines3's format; optimisers have none
    parameters.json                            the learned parameters, which a robot would be given
    figures/  report.html                      the products of sarah-figures and sarah-report

Every file but the model is read without unpickling, and no command reads the model or runs ``task.py``. So opening
somebody's run folder executes none of its code.
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import replace
from pathlib import Path
from typing import Any

from sarah.control.parameters import Box, Parameters
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task, is_portable
from sarah.errors import ConfigurationError, RunFolderError, shortened
from sarah.files import read_lines, read_text, replace_text
from sarah.recorded.folder import Folder, unreadable
from sarah.recorded.journal import Journal
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config, settings_by_key, write_config
from sarah.runs.kinds import TRAINING
from sarah.runs.recorded_task import SOURCE, record_task, recorded_task

EPISODES_BESIDE = 1000
"""Number of episodes, beside those of the budget, that a journal has room for: evaluations, and rows that were cut."""


class RunFolder(Folder):
    """The files of a training.

    :param path: path of the folder; :meth:`create` makes a new folder, :meth:`open` checks an existing one
    :param task: task of the training, if it is loaded; a task of a file is otherwise read, but not run
    """

    def __init__(self, path: Path, task: Task[Any] | None = None) -> None:
        super().__init__(path, TRAINING)
        self._task = task
        self.model_path = path / "model.zip"
        self.figures_path = path / "figures"
        self.report_path = path / "report.html"
        self._progress_path = path / "progress.csv"
        self._episodes_path = path / "episodes.csv"
        self._recommendations_path = path / "recommendations.csv"

    @classmethod
    def create(cls, path: Path, config: TrainingConfig) -> RunFolder:
        """Make a new run folder, and write the settings, the command and the versions of the training.

        :param path: path of the folder, which must be new or empty
        :param config: settings of the training
        :raises RunFolderError: if the folder is not empty or cannot be written
        :raises ConfigurationError: if the task is that of a script, which the folder could not record
        """
        if not is_portable(config.task):
            raise ConfigurationError(
                f"a run folder records tasks of files: put {config.task.name!r} into one, and use sarah.load_task"
            )
        run = cls(path, config.task if config.task.file is not None else None)

        def write() -> None:
            record_task(config.task, path)
            write_config(config, run.specification_path)

        run.begin(write)
        return run

    @classmethod
    def open(cls, path: Path, unfinished: bool = False, task: Task[Any] | None = None) -> RunFolder:
        """Open the folder of a training.

        :param path: path of the folder
        :param unfinished: whether to accept a training without learned parameters
        :param task: task of the training, which only a task of a file needs
        :raises RunFolderError: if the folder does not exist, has no learned parameters, or is another task's
        """
        run = cls(path, task)
        run.check(finished=not unfinished)
        return run

    def extend(self, config: TrainingConfig) -> None:
        """Make a finished training an unfinished one with a larger budget.

        :param config: settings with the larger budget
        """
        write_config(config, self.specification_path, self.result_path)

    def journal_of(self, config: TrainingConfig) -> AbstractContextManager[Journal]:
        """Journal of the training, as a context.

        :param config: settings of the training
        :raises ResumeError: if it was begun with other settings, code or versions, or is in use
        """
        settings = settings_by_key(replace(config, episodes=config.stages[0], extended_from=()))
        for name in ("pictures", "extended_from"):  # pictures change no result, and the journal has its extensions
            del settings[name]
        return self.journal(settings, config.episodes + EPISODES_BESIDE)

    def config(self) -> TrainingConfig:
        """Read the training's configuration.

        :raises RunFolderError: if the run folder was given a task that it was not made with
        """
        recorded = recorded_task(self.path)
        config = read_config(TrainingConfig, self.specification_path, recorded)
        if self._task is None:
            return config
        if self._task.identity != config.task.identity:
            file = config.task.file
            kept = "" if file is None else f": as it was, it is --task {self.path / SOURCE}:{file.attribute}"
            raise RunFolderError(f"{self.path} is of task {config.task.identity}, not {self._task.identity}{kept}")
        return replace(config, task=self._task)

    def config_text(self) -> str:
        """Read the text of ``config.yaml``."""
        try:
            return read_text(self.specification_path)
        except OSError as error:
            raise unreadable(self.specification_path, error) from error

    def append_episode(self, index: int, spec: EpisodeSpec, result: EpisodeResult) -> None:
        """Add one episode to ``episodes.csv``.

        :param index: number of the episode, from 0
        :param spec: specification of the episode
        :param result: result of the episode
        """
        parameters = dict(zip(spec.task.parameter_names, spec.parameters, strict=True))
        row = {"index": index, "seed": spec.seed, **parameters, **result.columns()}
        _append_row(self._episodes_path, tuple(row), row)

    def episodes(self, config: TrainingConfig | None = None) -> Iterator[dict[str, str]]:
        """Read ``episodes.csv``, row by row, as text; there are no rows before the first episode.

        :param config: settings of the training, if they have been read
        """
        return self._rows(self._episodes_path, config)

    def append_recommendation(self, episodes: int, parameters: Mapping[str, float]) -> None:
        """Add a row to ``recommendations.csv``.

        :param episodes: number of episodes that the recommendation is based on
        :param parameters: values of the recommended parameters, by name
        """
        row = {"episodes": episodes, **parameters}
        _append_row(self._recommendations_path, tuple(row), row)

    def recommendations(self, config: TrainingConfig | None = None) -> Iterator[dict[str, str]]:
        """Read ``recommendations.csv``, row by row, as text.

        :param config: settings of the training, if they have been read
        """
        return self._rows(self._recommendations_path, config)

    def append_progress(self, columns: Sequence[str], values: Mapping[str, Any]) -> None:
        """Add a row to ``progress.csv``.

        :param columns: names of all columns of the file
        :param values: values by column; other columns stay empty
        """
        _append_row(self._progress_path, columns, values)

    def widen_progress(self, columns: Sequence[str]) -> None:
        """Give ``progress.csv`` more columns.

        :param columns: names of the present columns, and then of new ones
        """
        text = io.StringIO(newline="")
        writer = csv.DictWriter(text, columns)
        writer.writeheader()
        writer.writerows(self._rows(self._progress_path))
        replace_text(self._progress_path, text.getvalue())

    def remove_records(self) -> None:
        """Remove the tables and curves of the episodes: a resumed training writes all of them anew."""
        tables = (self._episodes_path, self._recommendations_path, self._progress_path)
        for path in (*tables, *self.event_files()):
            path.unlink(missing_ok=True)

    def write_parameters(self, content: Mapping[str, Any]) -> None:
        """Write ``parameters.json``.

        :param content: values to write, which include the learned ``parameters`` by name
        """
        replace_text(self.result_path, json.dumps(content, indent=2) + "\n")

    def parameters(self, config: TrainingConfig | None = None) -> Parameters:
        """Read the learned parameters, in the order of the task.

        :param config: settings of the training, if they have been read
        :raises RunFolderError: if the file does not contain exactly the task's parameters
        """
        task = (config or self.config()).task
        return read_parameters(self.result_path, task.box)

    def _rows(self, path: Path, config: TrainingConfig | None = None) -> Iterator[dict[str, str]]:
        """Read a table, which has at most a row for each episode of the training."""
        if not path.exists():
            return
        try:
            yield from csv.DictReader(read_lines(path, (config or self.config()).episodes + 1))
        except (OSError, csv.Error) as error:
            raise unreadable(path, error) from error


def read_parameters(path: Path, box: Box) -> Parameters:
    """Read the parameters that a training or a session has learned.

    :param path: path of its ``parameters.json``
    :param box: ranges of the parameters
    :raises RunFolderError: if the file does not contain exactly these parameters
    """
    try:
        learned = read_result(path)["parameters"]
        if set(learned) != set(box.names):
            found = shortened(", ".join(map(str, learned)))
            raise ValueError(f"it names {found} instead of {', '.join(box.names)}")
        return box.checked([learned[name] for name in box.names])
    except (ValueError, KeyError, TypeError) as error:
        raise _no_parameters(path, error) from error


def read_result(path: Path) -> dict[str, Any]:
    """Read a ``parameters.json``.

    :param path: path of the file
    :raises RunFolderError: if it cannot be read, or is no object of JSON
    """
    try:
        content = json.loads(read_text(path))
        if not isinstance(content, dict):
            raise ValueError("it is no object")
        return content
    except OSError as error:
        raise unreadable(path, error) from error
    except (ValueError, RecursionError) as error:
        raise _no_parameters(path, error) from error


def _no_parameters(path: Path, error: Exception) -> RunFolderError:
    again = "without the file, --resume makes it again"
    return RunFolderError(f"{path} does not hold learned parameters ({error}): {again}")


def _append_row(path: Path, fields: Sequence[str], row: Mapping[str, Any]) -> None:
    is_new = not path.exists()
    with path.open("a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fields)
        if is_new:
            writer.writeheader()
        writer.writerow(row)
