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
import itertools
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import Task
from sarah.errors import ConfigurationError, RunFolderError, shortened
from sarah.files import check_name, quoted, read_lines, read_text, replace_text, write_command
from sarah.formats import read_json
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config, write_config
from sarah.runs.recorded_task import SOURCE, record_task, recorded_task
from sarah.versions import versions

EVENTS = "events.out.tfevents."
"""Prefix of the names of TensorBoard's files."""


def new_run_path(task: str, algo: str, seed: int) -> Path:
    """Make an empty folder for a run: ``runs/<task>/<algo>-s<seed>``, with a number behind it if that one exists.

    Whoever makes the folder has it, so that no other run takes it at the same time.

    :param task: name of the task, or of another kind of run
    :param algo: name of the algorithm
    :param seed: seed of the run
    :raises RunFolderError: if it cannot be made
    """
    path = base = Path("runs") / task / f"{algo}-s{seed}"
    try:
        base.parent.mkdir(parents=True, exist_ok=True)
        for number in itertools.count(2):
            try:
                path.mkdir()
                break
            except FileExistsError:
                path = base.with_name(f"{base.name}-{number}")
    except OSError as error:
        raise RunFolderError(f"cannot write run folder {path}: {error.strerror or error}") from error
    return path


class RunFolder:
    """The files of a training.

    :param path: path of the folder; :meth:`create` makes a new folder, :meth:`open` checks an existing one
    :param task: task of the training, if it is loaded; a task of a file is otherwise read, but not run
    """

    def __init__(self, path: Path, task: Task[Any] | None = None) -> None:
        self.path = path
        self._task = task
        self.model_path = path / "model.zip"
        self.figures_path = path / "figures"
        self.report_path = path / "report.html"
        self.journal_path = path / "journal.jsonl"
        self._versions_path = path / "versions.txt"
        self._progress_path = path / "progress.csv"
        self._config_path = path / "config.yaml"
        self._episodes_path = path / "episodes.csv"
        self._recommendations_path = path / "recommendations.csv"
        self._parameters_path = path / "parameters.json"

    @classmethod
    def create(cls, path: Path, config: TrainingConfig) -> RunFolder:
        """Make a new run folder, and write the settings, the command and the versions of the training.

        :param path: path of the folder, which must be new or empty
        :param config: settings of the training
        :raises RunFolderError: if the folder is not empty or cannot be written
        :raises ConfigurationError: if the task is that of a script, which the folder could not record
        """
        if not config.task.is_portable:
            raise ConfigurationError(
                f"a run folder records tasks of files: put {config.task.name!r} into one, and use sarah.load_task"
            )
        check_name(path)
        try:
            path.mkdir(parents=True, exist_ok=True)
            run = cls(path, config.task if config.task.file is not None else None)
            if any(path.iterdir()) or not run._claim():
                can_go_on = run._config_path.is_file() and run.journal_path.is_file() and not run.is_finished
                go_on = f", or go on with sarah-train --resume {quoted(path)}" if can_go_on else ""
                raise RunFolderError(f"run folder {path} is not empty: name another with --out{go_on}")
            write_command(path / "command.txt")
            run.write_versions()
            record_task(config.task, path)
            write_config(config, run._config_path)  # last, because a folder that has it can be resumed
        except RunFolderError:
            raise
        except OSError as error:
            raise RunFolderError(f"cannot write run folder {path}: {error.strerror or error}") from error
        return run

    def _claim(self) -> bool:
        """Make the journal's file, unless another training made it at the same time."""
        try:
            self.journal_path.touch(exist_ok=False)
        except FileExistsError:
            return False
        return True

    @classmethod
    def open(cls, path: Path, unfinished: bool = False, task: Task[Any] | None = None) -> RunFolder:
        """Open the folder of a training.

        :param path: path of the folder
        :param unfinished: whether to accept a training without learned parameters
        :param task: task of the training, which only a task of a file needs
        :raises RunFolderError: if the folder does not exist, has no learned parameters, or is another task's
        """
        run = cls(path, task)
        if not path.is_dir():
            raise RunFolderError(f"run folder {path} does not exist")
        kind = "training" if unfinished else "finished training"
        for file in (run._config_path,) if unfinished else (run._config_path, run._parameters_path):
            if not file.is_file():
                inside = next(iter(sorted(path.glob(f"*/{file.name}"))), None)
                hint = f", and {inside.parent} has one" if inside else ""
                raise RunFolderError(f"{path} is not the folder of a {kind}: it has no {file.name}{hint}")
        return run

    @classmethod
    def resumable(cls, path: Path, task: Task[Any] | None = None) -> RunFolder:
        """Open the folder of a training that was interrupted, or is finished.

        :param path: path of the folder
        :param task: task of the training, which only a task of a file needs
        :raises RunFolderError: if the folder does not exist, or lacks a file that a training is resumed from
        """
        run = cls(path, task)
        if not path.is_dir():
            raise RunFolderError(f"run folder {path} does not exist")
        for file in (run._config_path, run.journal_path):
            if not file.is_file():
                raise RunFolderError(f"{path} cannot be resumed: it has no {file.name}")
        return run

    @property
    def is_finished(self) -> bool:
        """Whether the training has finished, with learned parameters."""
        return self._parameters_path.is_file()

    def extend(self, config: TrainingConfig) -> None:
        """Make a finished training an unfinished one with a larger budget.

        :param config: settings with the larger budget
        """
        self._parameters_path.unlink()  # first: without it, the training of before would only be finished again
        write_config(config, self._config_path)

    def write_versions(self) -> None:
        """Write with which code and versions the training begins."""
        lines = (f"{name} {version}\n" for name, version in versions().items())
        replace_text(self._versions_path, "".join(lines))

    def versions(self) -> dict[str, str]:
        """Read the versions with which the training began, by name of the package."""
        try:
            lines = read_text(self._versions_path).splitlines()
        except OSError as error:
            raise _unreadable(self._versions_path, error) from error
        return {name: version for name, _, version in (line.partition(" ") for line in lines)}

    def config(self) -> TrainingConfig:
        """Read the training's configuration.

        :raises RunFolderError: if the run folder was given a task that it was not made with
        """
        recorded = recorded_task(self.path)
        config = read_config(TrainingConfig, self._config_path, recorded)
        if self._task is None:
            return config
        if self._task.identity != config.task.identity:
            kept = "" if config.task.file is None else f": the file as it was is {self.path / SOURCE}"
            raise RunFolderError(f"{self.path} is of task {config.task.identity}, not {self._task.identity}{kept}")
        return replace(config, task=self._task)

    def config_text(self) -> str:
        """Read the text of ``config.yaml``."""
        try:
            return read_text(self._config_path)
        except OSError as error:
            raise _unreadable(self._config_path, error) from error

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

    def event_files(self) -> list[Path]:
        """Paths of TensorBoard's files."""
        return sorted(path for path in self.path.glob(f"{EVENTS}*") if path.is_file())

    def remove_records(self) -> None:
        """Remove the tables and curves of the episodes: a resumed training writes all of them anew."""
        tables = (self._episodes_path, self._recommendations_path, self._progress_path)
        for path in (*tables, *self.path.glob(f"{EVENTS}*")):  # whatever they are: a FIFO of that name would block
            path.unlink(missing_ok=True)

    def write_parameters(self, content: Mapping[str, Any]) -> None:
        """Write ``parameters.json``.

        :param content: values to write, which include the learned ``parameters`` by name
        """
        replace_text(self._parameters_path, json.dumps(content, indent=2) + "\n")

    def parameters(self, config: TrainingConfig | None = None) -> tuple[float, ...]:
        """Read the learned parameters, in the order of the task.

        :param config: settings of the training, if they have been read
        :raises RunFolderError: if the file does not contain exactly the task's parameters
        """
        task = (config or self.config()).task
        names = task.parameter_names
        try:
            learned = read_json(read_text(self._parameters_path))["parameters"]
            if set(learned) != set(names):
                found = shortened(", ".join(map(str, learned)))
                raise ValueError(f"it names {found} instead of {', '.join(names)}")
            return task.checked([learned[name] for name in names])
        except OSError as error:
            raise _unreadable(self._parameters_path, error) from error
        except (ValueError, KeyError, TypeError) as error:
            raise RunFolderError(f"{self._parameters_path} does not hold learned parameters: {error}") from error

    def _rows(self, path: Path, config: TrainingConfig | None = None) -> Iterator[dict[str, str]]:
        """Read a table, which has at most a row for each episode of the training."""
        if not path.exists():
            return
        try:
            yield from csv.DictReader(read_lines(path, (config or self.config()).episodes + 1))
        except (OSError, csv.Error) as error:
            raise _unreadable(path, error) from error


def _append_row(path: Path, fields: Sequence[str], row: Mapping[str, Any]) -> None:
    is_new = not path.exists()
    with path.open("a", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, fields)
        if is_new:
            writer.writeheader()
        writer.writerow(row)


def _unreadable(path: Path, error: Exception) -> RunFolderError:
    return RunFolderError(f"{path} cannot be read: {getattr(error, 'strerror', None) or error}")
