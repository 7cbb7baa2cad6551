"""What a Gaussian process expects of actions, by its definition, and a replay buffer whose rewards are that."""

from typing import Any

import numpy as np
import pytest
from gymnasium import spaces
from stable_baselines3.common.utils import set_random_seed

from sarah.agents import RankReplayBuffer, SmoothedReplayBuffer
from sarah.agents.gaussian_process import LENGTHS, MOST_EPISODES, NOISES, PRIOR_QUANTILE, GaussianProcess

BOX = spaces.Box(-1, 1, (2,))


def hill(actions: np.ndarray) -> np.ndarray:
    return np.exp(-2 * np.sum((actions - 0.4) ** 2, axis=-1))


def played(kind: type[RankReplayBuffer] = SmoothedReplayBuffer, count: int = 200) -> RankReplayBuffer:
    """A buffer with noisy rewards of a hill."""
    buffer, rng = kind(150, BOX, BOX, "cpu"), np.random.default_rng(0)
    for action in rng.uniform(-1, 1, (count, 2)):
        add(buffer, action, float(hill(action)) + rng.normal(0, 0.5))
    return buffer


def add(buffer: RankReplayBuffer, action: np.ndarray, reward: float) -> None:
    zeros = np.zeros((1, 2), np.float32)
    buffer.add(zeros, zeros, np.array([action], np.float32), np.array([reward]), np.ones(1), [{}])


def sampled(buffer: RankReplayBuffer) -> tuple[np.ndarray, np.ndarray]:
    set_random_seed(0)
    samples = buffer.sample(2000)
    return samples.actions.numpy(), samples.rewards.numpy()[:, 0]


def test_sampled_rewards_are_near_the_truth_and_luck_is_rare() -> None:
    smoothed, plain = played(), played(RankReplayBuffer)
    assert (smoothed.rewards == plain.rewards).all()
    samples = [sampled(buffer) for buffer in (smoothed, plain)]
    errors = [np.std(rewards - hill(actions)) for actions, rewards in samples]
    assert errors[0] < 0.4 * errors[1]
    good = [hill(actions).mean() for actions, _ in samples]
    assert good[0] > good[1] + 0.1


def test_the_best_action_and_draws_near_it_are_near_the_top() -> None:
    buffer = played()
    best = buffer.best_action()
    assert hill(best) > 0.9 and best.tolist() not in buffer.actions[:, 0].tolist()
    set_random_seed(0)
    few, many = (hill(np.array([buffer.draw_near_best(0.5, draws) for _ in range(60)])).mean() for draws in (1, 16))
    assert many > few + 0.1


def test_what_is_known_follows_every_addition() -> None:
    buffer = played(count=30)
    before = buffer.best_action()
    for _ in range(40):
        add(buffer, np.array([-0.9, -0.9]), 5.0)
    assert np.linalg.norm(buffer.best_action() + 0.9) < 0.3 < np.linalg.norm(before + 0.9)
    buffer.reset()
    add(buffer, np.array([0.5, 0.5]), 1.0)
    fresh = SmoothedReplayBuffer(150, BOX, BOX, "cpu")
    add(fresh, np.array([0.5, 0.5]), 1.0)
    assert buffer.best_action().tolist() == fresh.best_action().tolist()
    buffer.reset()
    with pytest.raises(ValueError, match="the replay buffer is empty, so there is no best action"):
        buffer.best_action()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_reward_that_is_no_number_spoils_no_other(value: float) -> None:
    """So the loss still says that something is wrong."""
    buffer = played(count=60)
    best = buffer.best_action()
    add(buffer, np.array([0.0, 0.0]), value)
    actions, rewards = sampled(buffer)
    of_value = (actions == 0.0).all(axis=1)
    assert np.isfinite(rewards[~of_value]).all() and not np.isfinite(rewards[of_value]).any()
    assert np.linalg.norm(buffer.best_action() - best) < 0.3


def test_no_reward_is_expected_from_what_was_forgotten() -> None:
    """Old episodes beside a cliff, where the newest 500 never went, keep no place in the buffer."""
    buffer = SmoothedReplayBuffer(10_000, BOX, BOX, "cpu")
    rng = np.random.default_rng(0)
    for action in (*rng.uniform(-1, 0, (200, 2)), *rng.normal(0.5, 0.05, (500, 2))):
        add(buffer, action, float(action[0] > 0))
    actions, rewards = sampled(buffer)
    assert (actions[:, 0] > 0).all() and np.abs(rewards - 1).max() < 0.1


def tried(seed: int, count: int = 80, dim: int = 3) -> tuple[np.ndarray, np.ndarray]:
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (count, dim)), rng.normal(5.0, 2.0, count)


@pytest.mark.parametrize(("kernel", "scales"), [((0.6, 1.0), None), ((0.3, 0.1), None), ((0.6, 0.3), (1.0, 0.25, 2.0))])
def test_expectations_and_bounds_are_as_defined(kernel: tuple[float, float], scales: tuple[float, ...] | None) -> None:
    """Bounds by equation 2.26, with the variance between actions of the highest likelihood."""
    (actions, rewards), places = tried(0), tried(1)[0]
    length, noise = kernel

    def covariances(first: np.ndarray, second: np.ndarray) -> np.ndarray:
        differences = (first[:, None] - second) / (length * np.array(scales or 1.0))
        return np.exp(-0.5 * (differences**2).sum(axis=2))

    inverse = np.linalg.inv(covariances(actions, actions) + noise * np.eye(80))
    doubt, between = np.quantile(rewards, PRIOR_QUANTILE), covariances(places, actions)
    above, process = rewards - doubt, GaussianProcess(actions, rewards, kernel, scales)
    expected = doubt + between @ inverse @ above
    unknown = (above @ inverse @ above / 80) * (1 - np.einsum("ij,jk,ik->i", between, inverse, between))
    assert process.expected(places) == pytest.approx(expected)
    assert process.upper_bounds(places, 2.0) == pytest.approx(expected + 2.0 * np.sqrt(unknown))


def test_a_dip_of_a_short_length_scale_is_seen() -> None:
    """Between two good ranges that few trials separate, a longer length expects more than has ever been seen."""
    rng, found = np.random.default_rng(0), []
    tried_values = rng.choice([-0.95, -0.85, -0.6, -0.5], 50)
    for length_scales in (None, (0.25, 1.0)):
        buffer = SmoothedReplayBuffer(100, BOX, BOX, "cpu", length_scales=length_scales)
        for value in (*tried_values, -0.76, -0.74, *rng.uniform(0, 1, 10)):
            reward = 0.0 if value > -0.4 else 0.6 if -0.8 < value < -0.7 else 0.9
            add(buffer, np.array([value, rng.uniform(-1, 1)]), reward)
        found.append(-0.82 < buffer.best_action()[0] < -0.65)
    assert found == [True, False]


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ((1.0,), r"must be 2 numbers, not \(1.0,\)"),
        (0.25, "must be 2 numbers, not 0.25"),
        ((1.0, 0.0), "must be a number from 0.01 to 100, not 0.0"),
        ((1.0, float("nan")), "must be a number from 0.01 to 100, not nan"),
    ],
)
def test_bad_length_scales_are_refused(wrong: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        SmoothedReplayBuffer(10, BOX, BOX, "cpu", length_scales=wrong)


def test_an_optimist_leaves_a_good_place_for_a_possible_one() -> None:
    """Thirty fair trials on one side, one on the other that was as good."""
    actions = np.array([[-0.6, -0.6]] * 30 + [[0.6, 0.6]])
    rewards = np.array([0.5, 0.7] * 15 + [0.65])
    process = GaussianProcess(actions, rewards, (0.6, 1.0))
    assert process.best()[0] < -0.5 < process.best(deviations=1.0)[0]


@pytest.mark.parametrize(("scale", "shift"), [(1e-3, 100.0), (1e3, -4e3)])
def test_units_of_the_reward_make_no_difference(scale: float, shift: float) -> None:
    actions, rewards = tried(1)
    process, other = GaussianProcess(actions, rewards), GaussianProcess(actions, scale * rewards + shift)
    assert other.kernel == process.kernel
    assert other.expected(actions) == pytest.approx(scale * process.expected(actions) + shift)
    assert other.best() == pytest.approx(process.best(), abs=1e-6)


@pytest.mark.parametrize(
    ("noise", "waves", "part", "believed"),
    [(0.02, 0, 1, min(NOISES)), (0.5, 0, 1, max(NOISES)), (0.0, 8, 0, LENGTHS[1]), (0.0, 2, 0, LENGTHS[0])],
)
def test_noise_and_a_fine_landscape_are_recognised(noise: float, waves: int, part: int, believed: float) -> None:
    rng = np.random.default_rng(0)
    actions = rng.uniform(-1, 1, (200, 2))
    landscape = np.sin(waves * actions[:, 0]) if waves else np.exp(-2 * (actions**2).sum(axis=1))
    assert GaussianProcess(actions, landscape + rng.normal(0, noise, 200)).kernel[part] == believed


def test_a_few_episodes_choose_no_kernel_but_a_length() -> None:
    actions = np.linspace(-1, 1, 9)[:, None]
    assert GaussianProcess(actions, np.sin(9 * actions[:, 0])).kernel == (LENGTHS[0], NOISES[0])
    nothing = GaussianProcess(np.empty((0, 2)), np.empty(0))
    assert nothing.best(np.array([[0.1, 0.2], [0.3, 0.4]])).tolist() == [0.1, 0.2]
    lengths = [GaussianProcess(np.zeros((5, dim)), np.zeros(5)).kernel[0] for dim in (1, 4, 16)]
    assert lengths == [LENGTHS[0], LENGTHS[0], 2 * LENGTHS[0]]


@pytest.mark.parametrize("top", [(0.3, -0.2), (1.0, 0.4)])
def test_the_best_is_the_highest_in_the_box_tried_or_not(top: tuple[float, float]) -> None:
    rng = np.random.default_rng(3)
    actions = rng.uniform(-1, 1, (60, 2))
    process = GaussianProcess(actions, -((actions - top) ** 2).sum(axis=1))
    best = process.best()
    assert np.linalg.norm(best - top) < 0.25 and np.linalg.norm(actions - best, axis=1).min() > 1e-3
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 101)] * 2), axis=-1).reshape(-1, 2)
    assert process.expected(best[None])[0] >= process.expected(grid).max() - 1e-3
    assert np.abs(best).max() <= 1


@pytest.mark.parametrize("deviations", [0.0, 1.0])
def test_the_best_is_on_a_top_in_many_dimensions_too(deviations: float) -> None:
    """No step along one dimension is better."""
    rng = np.random.default_rng(0)
    actions = rng.uniform(-1, 1, (200, 12))
    rewards = np.exp(-((actions - 0.3) ** 2).sum(axis=1) / 4) + rng.normal(0, 0.01, 200)
    process = GaussianProcess(actions, rewards, length_scales=[0.5] + [1.0] * 11)
    best = process.best(deviations=deviations)
    steps = (best + 0.02 * np.vstack([np.eye(12), -np.eye(12)])).clip(-1, 1)
    assert process.upper_bounds(best[None], deviations)[0] > process.upper_bounds(steps, deviations).max() - 1e-6


def test_how_deep_a_few_disasters_are_makes_no_difference() -> None:
    """Bad luck of one episode in twenty."""
    rng = np.random.default_rng(0)
    actions = rng.uniform(-1, 1, (100, 2))
    rewards = 1 - (actions**2).sum(axis=1) + rng.normal(0, 0.1, 100)
    bad, worse = rewards.copy(), rewards.copy()
    bad[::20], worse[::20] = -20.0, -1000.0
    best, other = (GaussianProcess(actions, each).best() for each in (bad, worse))
    assert best.tolist() == other.tolist() and np.linalg.norm(best) < 0.7


def test_the_newest_episodes_decide() -> None:
    (actions, rewards), (others, other_rewards) = tried(0, MOST_EPISODES), tried(1, 100)
    process = GaussianProcess(np.vstack([others, actions]), np.concatenate([other_rewards, rewards]))
    assert process.expected(others).tolist() == GaussianProcess(actions, rewards).expected(others).tolist()
