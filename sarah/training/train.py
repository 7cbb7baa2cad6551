"""Training: an algorithm learns a task's parameters over a budget of episodes, and a run folder records it."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import closing
from dataclasses import asdict, dataclass
from functools import partial

import numpy as np
from tqdm import tqdm

from sarah.control.parameters import Parameters
from sarah.envs.sarah_env import draw_seed
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Executor, executor_of
from sarah.errors import LearningError, SarahError, one_line
from sarah.process import apart
from sarah.runs.config import TrainingConfig
from sarah.runs.recorded_episodes import RecordedEpisodes
from sarah.runs.run_folder import RunFolder
from sarah.training.learners import Learner, make_learner
from sarah.training.plan import EPISODES_PER_TRIAL, Stage, plan_of
from sarah.training.recorder import EpisodeRecorder

SUMMARY_EPISODES = 10
"""Number of episodes on unseen seeds in the final evaluation."""


@dataclass(frozen=True)
class Learned:
    """The result of a training.

    :param parameters: learned parameters, in the order of the task
    :param evaluation: evaluation of the learned parameters on unseen seeds
    :param baseline: evaluation of the task's neutral parameters on the same seeds; ``None`` if the task has none
    :param diverged: number of the training's episodes that diverged
    """

    parameters: Parameters
    evaluation: Evaluation
    baseline: Evaluation | None
    diverged: int


def simulated_episodes(config: TrainingConfig) -> int:
    """Number of episodes that a training simulates: its budget, and those that say what it has learned.

    :param config: settings of the training
    """
    stages = plan_of(config).stages
    if config.task.neutral is None:
        return config.episodes + SUMMARY_EPISODES * len(stages)
    compared = EPISODES_PER_TRIAL * sum(stage.trials > 0 for stage in stages)
    return config.episodes + 2 * SUMMARY_EPISODES * len(stages) + compared


def train(
    config: TrainingConfig,
    run: RunFolder,
    workers: Executor | None = None,
    progress_bar: bool = False,
    interrupted: Callable[[], bool] = lambda: False,
) -> Learned:
    """Train, and write the run folder. Episodes whose outcomes the run folder's journal has are not simulated again.

    :param config: settings of the training
    :param run: new run folder, or the run folder of this training, which was interrupted
    :param workers: executor that simulates the episodes; by default this process does. It changes no result
    :param progress_bar: whether to show a progress bar
    :param interrupted: function that says after every episode whether to stop
    :return: the learned parameters and their evaluation
    :raises RunFolderError: if another training uses the run folder
    :raises ResumeError: if the run folder was begun with other settings, code or versions, or does not repeat
    :raises LearningError: if the learning algorithm fails, or does not return finite numbers
    :raises TrainingInterruptedError: if ``interrupted`` asks to stop
    """
    executor = executor_of(workers)
    with apart() as outside, run.journal_of(config) as journal:
        episodes = RecordedEpisodes(journal, executor, interrupted, outside)
        return _train(config, run, episodes, progress_bar)


def _train(config: TrainingConfig, run: RunFolder, episodes: RecordedEpisodes, progress_bar: bool) -> Learned:
    plan = plan_of(config)
    generator, silent = np.random.default_rng(plan.seeds.trials), not progress_bar or sys.stderr is None
    with (
        tqdm(total=config.episodes, unit=" episodes", disable=silent) as progress,
        closing(EpisodeRecorder(run, plan, episodes, progress)) as recorder,
    ):
        learner = make_learner(plan, run, recorder, episodes)
        for stage in plan.stages:
            if stage.begin:
                episodes.extend(stage.end)
            choice = _choice(learner, stage, config.algo)
            parameters = _recommended(choice, stage, config, recorder, generator, episodes)
            learned = _evaluated(parameters, config, recorder, episodes, silent)
        episodes.journal.check_asked()
        recorder.finish(learned.evaluation)
    _write_parameters(learned, config, run)
    return learned


def _choice(learner: Learner, stage: Stage, algo: str) -> Parameters:
    """Learn, and return what the algorithm would choose. Many a library fails at numbers that it was not made for."""
    try:
        learner.learn(stage.learning)
        return learner.choice()
    except SarahError:
        raise
    except (ValueError, RuntimeError, ArithmeticError, AssertionError, LookupError, Warning) as error:
        raise LearningError(f"{algo} cannot go on: {one_line(error)}") from error


def _evaluated(
    parameters: Parameters, config: TrainingConfig, recorder: EpisodeRecorder, workers: Executor, silent: bool
) -> Learned:
    """Evaluate learned parameters, and what they are compared with, on seeds that no training has seen."""
    seeds, neutral = range(SUMMARY_EPISODES), config.task.neutral
    words = f"evaluating on {SUMMARY_EPISODES} unseen seeds"
    shown = partial(tqdm, total=SUMMARY_EPISODES, desc=words, unit=" episodes", leave=False, disable=silent)
    evaluation = evaluate(config.task, parameters, config.episode, seeds, workers, shown)
    baseline = None if neutral is None else evaluate(config.task, neutral, config.episode, seeds, workers, shown)
    return Learned(parameters, evaluation, baseline, recorder.diverged)


def _write_parameters(learned: Learned, config: TrainingConfig, run: RunFolder) -> None:
    evaluation, baseline = learned.evaluation, learned.baseline
    run.write_parameters(
        {
            "task": config.task.reference,
            "algorithm": config.algo,
            "seed": config.seed,
            "episodes": config.episodes,
            "diverged": learned.diverged,
            "parameters": dict(zip(config.task.parameter_names, learned.parameters, strict=True)),
            "stepping": getattr(config.episode, "stepping", None),
            "controller": asdict(config.episode.controller),
            "control_rate": config.episode.physics.control_rate,
            "evaluation": evaluation.summary(),
            "baseline": baseline and baseline.summary(),
            "chatters": baseline and evaluation.chatters(baseline),
        }
    )


def _recommended(
    choice: Parameters,
    stage: Stage,
    config: TrainingConfig,
    recorder: EpisodeRecorder,
    generator: np.random.Generator,
    workers: Executor,
) -> Parameters:
    """Try the parameters of which most is expected, first of all and then of those that were simulated elsewhere.

    Of those which are valid the ones are returned of which most is expected in the end.

    All trials meet the same seeds. Whether hips chatter is judged against the neutral parameters on these seeds too;
    the summary's stay unseen. If all trials fail, the best of them is returned, and the summary says what it lacks.
    """
    if not stage.trials:
        return recorder.tried.best(choice)
    seeds = [draw_seed(generator) for _ in range(stage.trial_episodes // stage.trials)]
    neutral = config.task.neutral
    baseline = None if neutral is None else evaluate(config.task, neutral, config.episode, seeds, workers)
    valid, failed = list[Parameters](), list[Parameters]()
    for trial in range(stage.trials):
        candidate = recorder.tried.best_simulated([*valid, *failed]) if trial else recorder.tried.best(choice)
        specs = [EpisodeSpec(candidate, seed, config.task, config.episode) for seed in seeds]
        results = tuple(workers.simulate_all(specs))
        for spec, result in zip(specs, results, strict=True):
            recorder.record(spec, result)
        evaluation = Evaluation(results, config.episode.least_clearance)
        (failed if evaluation.shortcomings(config.task.must_step, baseline) else valid).append(candidate)
    return recorder.tried.best_of(valid or failed)
