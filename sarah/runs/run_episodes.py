"""The episodes of a run folder, or of given parameters, from which a command chooses one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from sarah.episode.ending import TERMINATIONS
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import TASKS
from sarah.errors import ConfigurationError, RunFolderError
from sarah.runs.run_folder import RunFolder

LONGEST_REASON = 200
"""Length up to which a message quotes the error of a row, in characters."""


@dataclass(frozen=True)
class RunEpisode:
    """An episode to look at.

    :param name: name on the command line, for ``--episode``
    :param label: name in the page's list
    :param spec: specification of the episode
    :param score: score that the run folder has for it; ``None`` if it was not simulated there
    """

    name: str
    label: str
    spec: EpisodeSpec
    score: float | None = None

    def in_engine(self, engine: str) -> RunEpisode:
        """Make the same episode in a physics engine; it has no score if that is not the run folder's engine.

        :param engine: name of the engine
        :raises ConfigurationError: if there is no such engine
        """
        config = replace(self.spec.config, engine=engine)  # type: ignore[arg-type]  # checked
        spec = replace(self.spec, config=config)
        return replace(self, spec=spec, score=self.score if spec == self.spec else None)


def episodes_of_run(run: RunFolder) -> list[RunEpisode]:
    """Episodes of a training: its learned parameters, its best episode, and then all of its episodes.

    :param run: run folder of the training, which need not be finished
    :raises RunFolderError: if a row of ``episodes.csv`` cannot be read, or if there is no episode
    """
    training = run.config()
    task = TASKS[training.task]
    simulated = []
    for row in run.episodes():
        try:
            parameters = tuple(float(row[name]) for name in task.parameter_names)
            spec = EpisodeSpec(parameters, int(row["seed"]), task.name, training.episode)
            score, ending = float(row["score"]), TERMINATIONS[row["termination"]]
            label = f"episode {row['index']} · score {score:.2f} · {ending}"
            simulated.append(RunEpisode(row["index"], label, spec, score))
        except (KeyError, TypeError, ValueError) as error:
            reason = repr(error)[:LONGEST_REASON]
            raise RunFolderError(f"the episodes of {run.path} cannot be read: {reason}") from error
    shown = []
    if run.is_finished:
        spec = EpisodeSpec(run.parameters(), 0, task.name, training.episode)
        shown.append(RunEpisode("learned", "learned parameters · seed 0", spec))
    if simulated:
        best = max(simulated, key=lambda episode: episode.score or 0.0)
        shown.append(RunEpisode("best", f"best: {best.label}", best.spec, best.score))
    if not shown:
        raise RunFolderError(f"{run.path} has no episodes to show yet")
    return shown + simulated


def episode_of_parameters(parameters: Sequence[float]) -> RunEpisode:
    """Episode of given parameters, with seed 0.

    :param parameters: values of P1 to P5, or of V1 to V4 for the task balance
    :raises ConfigurationError: if there are not five or four of them, or if one is not allowed
    """
    for task in TASKS.values():
        if len(parameters) == len(task.parameter_names):
            label = f"{task.parameter_names[0][0]} = {', '.join(f'{value:g}' for value in parameters)} · seed 0"
            return RunEpisode("given", label, EpisodeSpec(tuple(parameters), 0, task.name))
    counts = " or ".join(
        f"{len(task.parameter_names)} numbers ({task.parameter_names[0]} to {task.parameter_names[-1]})"
        for task in TASKS.values()
    )
    raise ConfigurationError(f"parameters must be {counts}, not {len(parameters)}")


def choose_episode(episodes: list[RunEpisode], name: str | None) -> RunEpisode:
    """Find an episode by its name.

    :param episodes: episodes to choose from
    :param name: ``learned``, ``best`` or the index of an episode; the first one if ``None``
    :raises ConfigurationError: if there is no such episode
    """
    if name is None:
        return episodes[0]
    for episode in episodes:
        if episode.name == name:
            return episode
    words = [episode.name for episode in episodes if not episode.name.isdigit()]
    simulated = [episode.name for episode in episodes if episode.name.isdigit()]
    numbers = [f"{simulated[0]} to {simulated[-1]}"] if simulated else []
    raise ConfigurationError(f"unknown episode {name!r} (allowed: {', '.join(words + numbers)})")
