"""Training: an algorithm by name, one simulation after another, everything of it in a run folder."""

from __future__ import annotations

import dataclasses
import random
from collections.abc import Callable
from dataclasses import dataclass
from statistics import mean

import torch
from tqdm import tqdm

from sarah.episode.evaluation import Evaluation, summarise
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.tasks import BALANCE, TASKS
from sarah.episode.workers import Executor, Workers
from sarah.runs.config import TrainingConfig
from sarah.runs.journal import Journal
from sarah.runs.run_folder import RunFolder
from sarah.training.learners import learn
from sarah.training.recommendation import Parameters, candidates, merit
from sarah.training.recorder import EpisodeRecorder

SUMMARY_EPISODES = 10
"""Episodes on unseen seeds that the closing summary's score is the median of."""


@dataclass(frozen=True)
class Learned:
    """What a training ends with.

    :param parameters: the learned ones
    :param evaluation: how they do on unseen seeds
    :param without: how the task's neutral parameters do on the same seeds, if it has some
    :param diverged: how many of the training's simulations no longer returned numbers
    """

    parameters: Parameters
    evaluation: Evaluation
    without: Evaluation | None
    diverged: int


def train(
    config: TrainingConfig,
    run: RunFolder,
    workers: Executor | None = None,
    progress_bar: bool = False,
    interrupted: Callable[[], bool] = lambda: False,
    picture_interval: int = 0,
) -> Learned:
    """Train, and write the run folder. What the run folder's journal knows already is not simulated again.

    :param config: of the training
    :param run: a new run folder, or that of the same training, which was interrupted and goes on
    :param workers: that simulate; by default this process does. What is learned does not depend on them
    :param progress_bar: whether to show one
    :param interrupted: asked after every simulation whether to stop
    :param picture_interval: simulations between pictures for TensorBoard; 0 for none. They change no result
    :return: what was learned
    :raises RunFolderError: if another training uses the run folder, or it cannot be resumed here
    :raises LearningError: if what learns no longer returns numbers
    :raises TrainingInterruptedError: if ``interrupted`` says so
    """
    with Journal(run.journal_path, workers or Workers(), interrupted) as journal:
        return _train(config, run, journal, progress_bar, picture_interval)


def _train(
    config: TrainingConfig, run: RunFolder, journal: Journal, progress_bar: bool, picture_interval: int
) -> Learned:
    # The networks are small: more threads only wait for each other.
    torch.set_num_threads(1)
    compared = config.compared_simulations
    task = TASKS[config.task]
    seeds = range(SUMMARY_EPISODES)
    with tqdm(total=config.simulations, unit=" simulations", disable=not progress_bar) as progress:
        recorder = EpisodeRecorder(run, task, journal, progress, picture_interval)
        choice = learn(config, config.simulations - compared, run, recorder, journal)
        recorder.choose = None
        rivals = candidates(choice, recorder.tried, config.candidate_count, task.width)
        without = None if task.neutral is None else evaluate(task.neutral, config, seeds, journal)
        parameters = _compare(rivals, compared, config, recorder, journal, without)
    evaluation = evaluate(parameters, config, seeds, journal)
    recorder.close(evaluation)
    run.write_parameters(
        {
            "task": config.task,
            "algorithm": config.algo,
            "seed": config.seed,
            "simulations": config.simulations,
            "diverged": recorder.diverged,
            "parameters": dict(zip(task.parameter_names, parameters, strict=True)),
            "stepping": config.episode.stepping if task == BALANCE else None,
            "evaluation": dataclasses.asdict(evaluation),
            "without": without and dataclasses.asdict(without),
            "chatters": without and evaluation.chatters(without),
        }
    )
    return Learned(parameters, evaluation, without, recorder.diverged)


def _compare(
    rivals: list[Parameters],
    simulations: int,
    config: TrainingConfig,
    recorder: EpisodeRecorder,
    workers: Executor,
    without: Evaluation | None,
) -> Parameters:
    """Simulate the candidates in turn, each round on one seed for all, and return the best."""
    generator = random.Random(config.seed)
    specs: list[EpisodeSpec] = []
    while len(specs) < simulations:
        seed = generator.randrange(FIRST_TRAINING_SEED, 2**32)
        specs += [EpisodeSpec(rival, seed, config.task, config.episode) for rival in rivals]
    results: dict[Parameters, list[EpisodeResult]] = {rival: [] for rival in rivals}
    specs = specs[:simulations]
    for spec, result in zip(specs, workers.simulate_all(specs), strict=True):
        recorder.record({**result.fields(), "seed": spec.seed, "parameters": spec.parameters})
        results[spec.parameters].append(result)
    return max(rivals, key=lambda rival: _rank(results[rival], without))


def _rank(results: list[EpisodeResult], without: Evaluation | None) -> tuple[bool, float]:
    """What is a gait and does not chatter comes first, and among equals the best mean merit."""
    if not results:
        return (False, 0.0)
    evaluation = summarise(results)
    chatters = without is not None and evaluation.chatters(without)
    return (evaluation.is_gait and not chatters, mean(merit(result.fields()) for result in results))


def evaluate(
    parameters: Parameters, config: TrainingConfig, seeds: range, workers: Executor | None = None
) -> Evaluation:
    """Simulate parameters on some seeds.

    :param parameters: of the pattern generator
    :param config: of the training they come from
    :param seeds: of the episodes; those below 2^31 are in no training
    :param workers: that simulate; by default this process does
    """
    specs = [EpisodeSpec(parameters, seed, config.task, config.episode) for seed in seeds]
    return summarise((workers or Workers()).simulate_all(specs))
