"""Training: an algorithm by name, one simulation after another, everything of it in a run folder."""

from __future__ import annotations

import dataclasses
import random
from collections import deque
from dataclasses import dataclass
from statistics import mean
from typing import Any

import numpy as np
import torch
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger, configure
from stable_baselines3.common.noise import NormalActionNoise
from stable_baselines3.common.off_policy_algorithm import OffPolicyAlgorithm
from stable_baselines3.common.vec_env import VecEnv
from tqdm import tqdm

from sarah.agents.naf import NAF, PRESETS
from sarah.config import SEARCHERS, Randomisation, TrainingConfig
from sarah.envs import FIRST_TRAINING_SEED, draw_seed, observation_from, parameters_from
from sarah.episode import Episode, EpisodeSpec, simulate
from sarah.evaluation import Evaluation, summarise
from sarah.recommendation import SIMULATIONS_PER_CANDIDATE, Parameters, candidate_count, candidates, merit
from sarah.runs import RunFolder
from sarah.search import Searcher, make_searcher
from sarah.tasks import BALANCE, TASKS, Task
from sarah.vec_env import EpisodeVecEnv, LateRankReplayBuffer, LateReplayBuffer
from sarah.workers import Job, Workers

UPDATES_PER_SIMULATION = 5
WARM_UP = 40
"""Simulations before the agent learns; twice the slots, if that is more, so that it begins with as many outcomes."""
SUMMARY_EPISODES = 10
"""Episodes on unseen seeds that the closing summary's score is the median of."""
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


def spread_seed(config: TrainingConfig) -> int:
    """The seed of what learns and of its episodes: from neighbouring seeds come trainings that share no episode."""
    return int(np.random.SeedSequence(config.seed).generate_state(1)[0]) // 2


def make_agent(config: TrainingConfig, env: VecEnv) -> OffPolicyAlgorithm:
    """Make the reinforcement learner that a configuration names, with the settings that suit one action per episode.

    :param config: of the training
    :param env: to learn from
    """
    common: dict[str, Any] = dict(
        seed=spread_seed(config), gradient_steps=UPDATES_PER_SIMULATION, learning_starts=max(WARM_UP, 2 * config.slots)
    )
    if config.algo == "naf":
        return NAF("MlpPolicy", env, **{**PRESETS["one-step"], "replay_buffer_class": LateRankReplayBuffer, **common})
    # Their defaults are for long episodes of small rewards; here the reward is the return.
    settings = dict(
        batch_size=64,
        gamma=0.0,
        policy_kwargs=dict(net_arch=[64, 64]),
        replay_buffer_class=LateReplayBuffer,
        **common,
    )
    if config.algo == "sac":
        return SAC("MlpPolicy", env, **settings)
    dimensions = len(TASKS[config.task].parameter_names)
    noise = NormalActionNoise(np.zeros(dimensions), np.full(dimensions, 0.2))
    return {"td3": TD3, "ddpg": DDPG}[config.algo]("MlpPolicy", env, action_noise=noise, **settings)


class EpisodeRecorder(BaseCallback):
    """Writes every simulation to ``episodes.csv`` and to the logger.

    :param run: where to
    :param task: whose parameters they are
    :param log: where to as well
    """

    def __init__(self, run: RunFolder, task: Task, log: Logger) -> None:
        super().__init__()
        self.log = log
        self._names = task.parameter_names
        self.tried: list[tuple[Parameters, float]] = []
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


@dataclass(frozen=True)
class Learned:
    """What a training ends with.

    :param parameters: the learned ones
    :param evaluation: how they do on unseen seeds
    :param without: how the task's neutral parameters do on the same seeds, if it has some
    """

    parameters: Parameters
    evaluation: Evaluation
    without: Evaluation | None


def train(
    config: TrainingConfig, run: RunFolder, workers: Workers | None = None, progress_bar: bool = False
) -> Learned:
    """Train, and write the run folder.

    :param config: of the training
    :param run: a new run folder
    :param workers: that simulate; by default this process does. What is learned does not depend on them
    :param progress_bar: whether to show one
    :return: what was learned
    """
    # The networks are small: more threads only wait for each other.
    torch.set_num_threads(1)
    count = candidate_count(config.simulations)
    compared = count * SIMULATIONS_PER_CANDIDATE if count > 1 else 0
    workers = workers or Workers()
    task = TASKS[config.task]
    log = configure(str(run.path), ["csv", "tensorboard"])
    recorder = EpisodeRecorder(run, task, log)
    if config.algo in SEARCHERS:
        choice = _search(config, config.simulations - compared, recorder, workers, progress_bar)
    else:
        choice = _learn(config, config.simulations - compared, run, recorder, workers, progress_bar)
    rivals = candidates(choice, recorder.tried, count, task.high - task.low)
    parameters = _compare(rivals, compared, config, recorder, workers)
    log.close()
    seeds = range(SUMMARY_EPISODES)
    evaluation = evaluate(parameters, config, seeds, workers)
    without = None if task.neutral is None else evaluate(task.neutral, config, seeds, workers)
    run.write_parameters(
        {
            "task": config.task,
            "algorithm": config.algo,
            "seed": config.seed,
            "simulations": config.simulations,
            "parameters": dict(zip(task.parameter_names, parameters, strict=True)),
            "stepping": config.episode.stepping if task == BALANCE else None,
            "evaluation": dataclasses.asdict(evaluation),
            "without": without and dataclasses.asdict(without),
            "chatters": without and evaluation.chatters(without),
        }
    )
    return Learned(parameters, evaluation, without)


def _learn(
    config: TrainingConfig,
    simulations: int,
    run: RunFolder,
    recorder: EpisodeRecorder,
    workers: Workers,
    progress_bar: bool,
) -> Parameters:
    """Train an agent and save it; its choice is returned."""
    env = EpisodeVecEnv(config.task, config.episode, simulations, config.slots, workers)
    model = make_agent(config, env)
    model.set_logger(recorder.log)
    # The recorder logs every simulation; stable-baselines3's own averages are left out.
    model.learn(
        simulations + config.slots - 1,
        callback=recorder,
        log_interval=None,  # type: ignore[arg-type]
        progress_bar=progress_bar,
    )
    model.save(run.model_path)
    return chosen_parameters(model, config)


def _search(
    config: TrainingConfig, simulations: int, recorder: EpisodeRecorder, workers: Workers, progress_bar: bool
) -> Parameters:
    """Let a black-box optimiser try parameters, as many in flight as there are slots; its choice is returned."""
    task = TASKS[config.task]
    searcher = make_searcher(config.algo, len(task.parameter_names), spread_seed(config))
    generator = np.random.default_rng(spread_seed(config))
    running: deque[tuple[np.ndarray, EpisodeSpec, Job]] = deque()
    for _ in tqdm(range(simulations), disable=not progress_bar):
        while len(running) == config.slots or not searcher.ready():
            _tell_oldest(running, searcher, recorder)
        action = searcher.ask()
        spec = EpisodeSpec(parameters_from(action, task), draw_seed(generator), config.task, config.episode)
        running.append((action, spec, workers.submit(simulate, spec)))
    while running:
        _tell_oldest(running, searcher, recorder)
    return parameters_from(searcher.choice(), task)


def _tell_oldest(
    running: deque[tuple[np.ndarray, EpisodeSpec, Job]], searcher: Searcher, recorder: EpisodeRecorder
) -> None:
    action, spec, job = running.popleft()
    result = job.result()
    searcher.tell(action, result.episode_return)
    recorder.record({**result.fields(), "seed": spec.seed, "parameters": spec.parameters})


def chosen_parameters(model: OffPolicyAlgorithm, config: TrainingConfig) -> Parameters:
    """What the agent does, without exploration, when the robot as designed stands before it.

    :param model: the agent
    :param config: of the training; the randomisation is left out
    :return: the parameters
    """
    task = TASKS[config.task]
    nominal = dataclasses.replace(config.episode, randomisation=Randomisation(enabled=False, start_speed=0.0))
    episode = Episode(nominal, 0, task)
    try:
        observation = observation_from(episode.stand())
    finally:
        episode.close()
    action, _ = model.predict(observation, deterministic=True)
    return parameters_from(action, task)


def _compare(
    rivals: list[Parameters], simulations: int, config: TrainingConfig, recorder: EpisodeRecorder, workers: Workers
) -> Parameters:
    """Simulate the candidates in turn, each round on one seed for all, and return the one of the best mean merit."""
    generator = random.Random(config.seed)
    specs: list[EpisodeSpec] = []
    while len(specs) < simulations:
        seed = generator.randrange(FIRST_TRAINING_SEED, 2**32)
        specs += [EpisodeSpec(rival, seed, config.task, config.episode) for rival in rivals]
    merits: dict[Parameters, list[float]] = {rival: [] for rival in rivals}
    specs = specs[:simulations]
    for spec, result in zip(specs, workers.simulate_all(specs), strict=True):
        recorder.record({**result.fields(), "seed": spec.seed, "parameters": spec.parameters})
        merits[spec.parameters].append(recorder.tried[-1][1])
    return max(rivals, key=lambda rival: mean(merits[rival] or [0.0]))


def evaluate(
    parameters: Parameters, config: TrainingConfig, seeds: range, workers: Workers | None = None
) -> Evaluation:
    """Simulate parameters on some seeds.

    :param parameters: of the pattern generator
    :param config: of the training they come from
    :param seeds: of the episodes; those below 2^31 are in no training
    :param workers: that simulate; by default this process does
    """
    specs = [EpisodeSpec(parameters, seed, config.task, config.episode) for seed in seeds]
    return summarise((workers or Workers()).simulate_all(specs))
