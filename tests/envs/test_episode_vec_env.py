"""Episodes in flight: outcomes in order, each stored with the action that it came from."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from laboratory import COARSE_PHYSICS, RESULT, NoPhysics

from sarah import STEPPING, EpisodeConfig, simulate
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.sarah_env import parameters_from
from sarah.episode.spec import FIRST_TRAINING_SEED, EpisodeSpec
from sarah.episode.task_answers import disturbances_of
from sarah.episode.workers import Job, Outcome, Workers, begin_episode
from sarah.errors import ConfigurationError, LearningError
from sarah.training.replay import LateRankReplayBuffer

SHORT = EpisodeConfig(time_limit=1.3, physics=COARSE_PHYSICS)
ACTIONS = np.random.default_rng(0).uniform(-1.0, 1.0, (6, 5)).astype(np.float32)


def played(slots: int, episodes: int = 4, seed: int = 1) -> tuple[list[np.ndarray], list[float], list[dict]]:
    """Observations before each step, and rewards and infos after it."""
    env = EpisodeVecEnv("stepping", SHORT, episodes, slots, Workers())
    env.seed(seed)
    observations, rewards, infos = [env.reset()], [], []
    for step in range(episodes + slots - 1):
        observation, reward, done, info = env.step(ACTIONS[min(step, episodes - 1)][None])
        assert done.all() == (info[0]["transition"] is not None)  # otherwise learners would count an episode of 0
        assert isinstance(observation, np.ndarray)
        observations.append(observation)
        rewards.append(float(reward[0]))
        infos.append(info[0])
    return observations, rewards, infos


def test_outcomes_come_in_order_after_the_slots_are_full() -> None:
    seen = []
    for slots in (1, 3):
        observations, rewards, infos = played(slots)
        assert all(info == {"transition": None} for info in infos[: slots - 1])
        for index, (reward, info) in enumerate(zip(rewards[slots - 1 :], infos[slots - 1 :], strict=True)):
            observation, action, _ = info.pop("transition")
            assert np.array_equal(action, ACTIONS[index])
            assert np.array_equal(observation, observations[index][0])
            spec = info["spec"]
            assert spec == EpisodeSpec(parameters_from(ACTIONS[index], STEPPING), spec.seed, config=SHORT)
            assert spec.seed >= FIRST_TRAINING_SEED
            assert info["result"] == simulate(spec) and info["disturbances"] == disturbances_of(spec)
            assert reward == pytest.approx(info["result"].episode_return)
        seen.append(infos[slots - 1 :])
    assert seen[0] == seen[1]


def test_what_cannot_be_asked_is_refused() -> None:
    for episodes, slots, words in (
        (1, 0, "slots must be between 1 and 2147483648, not 0"),
        ("3", 1, "episodes must be between 0 and 2147483648, not '3'"),
    ):
        with pytest.raises(ConfigurationError, match=f"^{words}$"):
            EpisodeVecEnv("stepping", SHORT, episodes, slots, Workers())  # type: ignore[arg-type]
    env = EpisodeVecEnv(replace(STEPPING, name="other", disturbances=None), SHORT, 1, 1, Workers())
    with pytest.raises(ConfigurationError, match="call reset before step"):
        env.step(ACTIONS[:1])
    env.reset()
    assert set(env.step(ACTIONS[:1])[3][0]) & {"spec", "disturbances"} == {"spec"}  # its task names none
    with pytest.raises(ConfigurationError, match="call reset before step"):
        env.step(ACTIONS[:1])
    for refused in (lambda: env.set_attr("config", SHORT), lambda: env.env_method("render")):
        with pytest.raises(NotImplementedError):
            refused()


def test_a_task_an_episode_and_one_for_each_that_stands_at_first() -> None:
    """Tasks cost a scheduler, so standing is not another one for every episode."""

    class Counting(Workers):
        tasks = subjects = 0

        def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
            self.tasks += 1
            self.subjects += sum(subject is not None for subject in subjects)
            return super().submit(function, *subjects)

    for episodes in (1, 5):
        workers = Counting()
        env = EpisodeVecEnv("stepping", SHORT, episodes, 3, workers)
        env.reset()
        for _ in range(episodes + 2):
            env.step(ACTIONS[:1])
        assert workers.tasks == episodes + min(episodes, 3)
        assert workers.subjects == 2 * episodes  # each stands once, and is simulated once


def test_seed_decides_and_a_second_reset_goes_on() -> None:
    def seeds_of_two_resets(seed: int) -> list[int]:
        env, seeds = EpisodeVecEnv("stepping", SHORT, 2, 1, Workers()), []
        env.seed(seed)
        for _ in range(2):
            env.reset()
            seeds += [env.step(ACTIONS[:1])[3][0]["spec"].seed for _ in range(2)]
        return seeds

    first = seeds_of_two_resets(1)
    assert len(set(first)) == 4
    assert first == seeds_of_two_resets(1) != seeds_of_two_resets(2)


def test_a_buffer_stores_each_outcome_with_its_own_action() -> None:
    env = EpisodeVecEnv("stepping", SHORT, 4, 2, Workers())
    buffer = LateRankReplayBuffer(10, env.observation_space, env.action_space)
    env.seed(1)
    observation = env.reset()
    for step in range(5):
        action = ACTIONS[min(step, 3)][None]
        after, reward, done, infos = env.step(action)
        assert isinstance(after, np.ndarray)
        buffer.add(observation, after, action, reward, done, infos)
        observation = after
    assert buffer.size() == 4 and (buffer.dones[:4] == 1.0).all()
    assert np.array_equal(buffer.actions[:4, 0], ACTIONS[:4])
    assert buffer.rewards[:4, 0] == pytest.approx([info["result"].episode_return for info in played(1)[2]])


def test_returns_beyond_32_bits_are_named() -> None:
    class Excited(Workers):
        def submit(self, function: Callable[..., Any], *subjects: Any) -> Job:
            if function is begin_episode:
                return super().submit(function, *subjects)
            return super().submit(lambda: Outcome(replace(RESULT, episode_return=-1e39), NoPhysics().read()))

    env = EpisodeVecEnv("stepping", SHORT, 2, 2, Excited())
    env.reset()
    env.step(ACTIONS[:1])
    with pytest.raises(LearningError, match=r"^a return of -1e\+39 is too large for an agent, .*reward$"):
        env.step(ACTIONS[:1])
