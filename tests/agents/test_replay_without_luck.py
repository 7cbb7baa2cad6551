"""Corrected returns lack what known disturbances explain, and the replay buffer judges actions by what is left."""

import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from sklearn.linear_model import Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import VecNormalize

from sarah.agents import LocalNAF, RankReplayBuffer, buffers
from sarah.agents.corrections import FEWEST_EPISODES, MOST_FITTED, PENALTY
from sarah.agents.corrections import corrected as corrected_of_actions
from sarah.agents.gaussian_process import bounded

BOX = spaces.Box(-1, 1, (2,))


class Lottery(gymnasium.Env[np.ndarray, np.ndarray]):
    """The first disturbance decides most of the reward, the second none of it, and the action a little."""

    observation_space = spaces.Box(-1, 1, (1,))
    action_space = BOX

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[np.ndarray, dict[str, Any]]:
        super().reset(seed=seed)
        return np.zeros(1, np.float32), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict[str, Any]]:
        luck, other = self.np_random.normal(size=2)
        return np.zeros(1, np.float32), worth(action) + 2 * luck, True, False, {"disturbances": (luck, other)}


def worth(action: np.ndarray) -> float:
    """Value of an action: the best is (0.5, 0.5)."""
    return float(np.exp(-8 * np.sum((np.asarray(action) - 0.5) ** 2)))


def add(buffer: RankReplayBuffer, number: float, action: Any, reward: float, **info: Any) -> None:
    obs = np.full((1, 1), number)
    buffer.add(obs, obs, np.array([action]), np.array([reward]), np.ones(1), [info])


def played(episodes: int, buffer_size: int = 1000, tells: bool = True, **arguments: Any) -> RankReplayBuffer:
    """A buffer with uniform actions, which carry their number as observation."""
    env, buffer = Lottery(), RankReplayBuffer(buffer_size, BOX_OF_NUMBERS, BOX, "cpu", **arguments)
    env.reset(seed=0)
    rng = np.random.default_rng(0)
    for number in range(episodes):
        action = rng.uniform(-1, 1, 2)
        _, reward, _, _, info = env.step(action)
        add(buffer, number, action, reward, **(info if tells else {}))
    return buffer


BOX_OF_NUMBERS = spaces.Box(-np.inf, np.inf, (1,))


def without_luck(buffer: RankReplayBuffer, first: int) -> np.ndarray:
    """Corrected rewards of the numbered transitions of a buffer from the first that it still has, in their order."""
    numbers = buffer.observations[: buffer.size(), 0, 0]
    order = np.argsort(numbers)
    assert numbers[order[0]] == first and buffer.disturbances is not None
    return corrected_of_actions(buffer.rewards[order, 0], buffer.actions[order, 0], buffer.disturbances[order])


def test_the_best_action_is_a_good_one_and_not_a_lucky_one() -> None:
    assert worth(played(600).best_action()) > 0.8 > 0.3 > worth(played(600, tells=False).best_action())


@pytest.mark.parametrize("buffer_size", [1000, 50])
def test_sampled_rewards_are_corrected_and_stored_ones_are_not(buffer_size: int) -> None:
    """Also where the oldest have been overwritten."""
    buffer = played(120, buffer_size, temperature=0.0)
    first = max(0, 120 - buffer_size)
    batch = buffer.sample(200)
    numbers = batch.observations[:, 0].numpy().astype(int) - first
    np.testing.assert_array_equal(batch.rewards[:, 0], without_luck(buffer, first)[numbers].astype(np.float32))
    luck = played(120, temperature=0.0, tells=False)
    np.testing.assert_array_equal(np.sort(buffer.rewards[: buffer.size(), 0]), np.sort(luck.rewards[first:120, 0]))


def test_ranks_are_those_of_corrected_rewards() -> None:
    """The one that did best of all with bad luck is drawn, though luck alone made others better."""
    buffer = played(0, temperature=1e5)
    for number in range(100):
        luck = 1.0 if number % 2 else -1.0
        add(buffer, number, (0, 0), luck + (1.5 if number == 40 else 0.0), disturbances=[luck])
    assert set(buffer.sample(100).observations[:, 0].numpy()) == {40} and buffer.rewards[40] < buffer.rewards[41]


def test_rewards_are_corrected_before_they_are_normalised() -> None:
    env = VecNormalize(make_vec_env(Lottery))
    env.ret_rms.var = np.array(4.0)
    buffer = played(120, temperature=0.0)
    set_random_seed(0)
    plain = buffer.sample(50)
    set_random_seed(0)
    np.testing.assert_allclose(buffer.sample(50, env).rewards, plain.rewards / 2, rtol=1e-6)


AS_BEFORE = "a list of finite numbers as in the episodes before, 2 of them, not"
ALWAYS = "there in every episode or in none"


@pytest.mark.parametrize(
    ("before", "info", "words"),
    [
        ({"episodes": 3}, {"disturbances": (1.0,)}, f"{AS_BEFORE} [1.0]"),
        ({"episodes": 3}, {"disturbances": (1.0, "a")}, f"{AS_BEFORE} (1.0, 'a')"),
        ({"episodes": 3}, {"disturbances": 3.0}, f"{AS_BEFORE} 3.0"),
        ({"episodes": 3}, {}, ALWAYS),
        ({"episodes": 3, "tells": False}, {"disturbances": [1.0]}, ALWAYS),
        ({"episodes": 0}, {"disturbances": [np.float64(np.inf)]}, "a list of finite numbers, not [inf]"),
    ],
)
def test_other_disturbances_than_before_are_refused(before: Any, info: dict[str, Any], words: str) -> None:
    buffer = played(**before)
    with pytest.raises(ValueError) as refused:
        add(buffer, 3, (0, 0), 1.0, **info)
    assert str(refused.value) == f'info["disturbances"] must be {words}' and buffer.size() == before["episodes"]


def test_an_action_that_is_no_number_is_refused_before_it_is_stored() -> None:
    buffer = played(3)
    with pytest.raises(
        ValueError, match=r"an action must be finite, not \[\[nan, 0.0\]\]: see the agent and its noise"
    ):
        add(buffer, 3, (np.nan, 0.0), 1.0, disturbances=[0.0, 0.0])
    assert buffer.size() == 3


def test_after_a_reset_there_may_be_others_or_none() -> None:
    buffer = played(30)
    infos: list[dict[str, Any]] = [{"disturbances": np.zeros(5)}, {}, {"disturbances": []}]
    for number, info in enumerate(infos):
        buffer.reset()
        add(buffer, number, (0, 0), 9.0, **info)
        assert buffer.sample(3).rewards.tolist() == [[9.0]] * 3


def test_a_saved_buffer_goes_on_as_the_one_that_was_saved() -> None:
    buffer = played(40, 30)
    loaded = pickle.loads(pickle.dumps(buffer))
    for each in (buffer, loaded):
        add(each, 40, (0.2, 0.2), 1.0, disturbances=(1.0, 2.0))
    np.testing.assert_array_equal(without_luck(loaded, 11), without_luck(buffer, 11))
    assert loaded.best_action().tolist() == buffer.best_action().tolist()


def test_an_agent_learns_from_several_environments_that_tell() -> None:
    model = LocalNAF("MlpPolicy", make_vec_env(Lottery, n_envs=2, seed=0), learning_starts=4, seed=0).learn(30)
    assert isinstance(model.replay_buffer, RankReplayBuffer) and model.replay_buffer.disturbances is not None
    rewards, luck = model.replay_buffer.rewards[:30, 0], model.replay_buffer.disturbances[:30, 0]
    assert np.corrcoef(rewards, luck)[0, 1] > 0.95


def corrected(returns: np.ndarray, disturbances: np.ndarray) -> np.ndarray:
    """Corrected returns of one action."""
    return corrected_of_actions(returns, np.full((len(returns), 2), 0.3), disturbances)


def drawn(seed: int, number: int = 60, width: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Returns that disturbances decide in part, and the disturbances."""
    rng = np.random.default_rng(seed)
    disturbances = rng.uniform(-1.0, 3.0, (number, width))
    first, second, third = disturbances.T[:3]
    returns = 2.0 + (first + 1.0) * (second + 1.0) - third**2 + rng.normal(size=number)
    return returns, disturbances


@pytest.mark.parametrize("seed", range(5))
def test_it_is_a_ridge_regression_on_squares_and_products(seed: int) -> None:
    """Whatever the units are."""
    returns, disturbances = drawn(seed)
    features = (StandardScaler(), PolynomialFeatures(2, include_bias=False), StandardScaler())
    explanation = make_pipeline(*features, Ridge(alpha=PENALTY)).fit(disturbances, returns)
    without = corrected(returns, disturbances)
    np.testing.assert_allclose(without, returns - explanation.predict(disturbances) + returns.mean(), rtol=1e-9)
    np.testing.assert_allclose(corrected(returns, disturbances[:, ::-1] * 1e200 + 3e200), without)
    np.testing.assert_allclose(corrected(1e200 * returns, disturbances), 1e200 * without)


def test_what_was_learned_is_not_taken_for_luck_that_changed_meanwhile() -> None:
    """The agent comes to the best actions while a battery runs down, whose charge decides a little or nothing."""
    rng, time = np.random.default_rng(0), np.linspace(0, 1, 200)
    actions = np.clip(rng.normal(0.5 * time[:, None], 0.8 - 0.7 * time[:, None], (200, 2)), -1, 1)
    worths = np.array([worth(action) for action in actions])
    luck = rng.normal(0, 0.1, 200)
    charge = (1 - time + rng.normal(0, 0.1, 200))[:, None]
    for effect, largest in ((0.0, 0.2), (charge[:, 0], 0.4)):
        returns = worths + luck + effect
        error = np.std(corrected_of_actions(returns, actions, charge) - worths - luck)
        assert error < largest * np.std(corrected(returns, charge) - worths - luck)


def test_hundreds_of_disturbances_leave_what_actions_decide() -> None:
    rng = np.random.default_rng(0)
    disturbances, returns = rng.normal(size=(100, 300)), rng.normal(size=100)
    without = corrected(returns + 3 * disturbances[:, 7], disturbances)
    assert np.corrcoef(without, returns)[0, 1] > 0.6 and 0.6 < without.std() < 1.3


def test_ten_disturbances_that_matter_are_all_known() -> None:
    rng = np.random.default_rng(0)
    disturbances, rest = rng.normal(size=(150, 10)), 0.5 * rng.normal(size=150)
    assert np.std(corrected(disturbances.sum(axis=1) / np.sqrt(10) + rest, disturbances) - rest) < 0.45


@pytest.mark.parametrize("seed", range(5))
def test_many_that_explain_nothing_hide_none_that_do(seed: int) -> None:
    returns, disturbances = drawn(seed)
    chance = np.random.default_rng(9).normal(size=(60, 20))
    among = corrected(returns, np.hstack([chance, disturbances]))
    assert np.std(among - corrected(returns, disturbances)) < 0.4 * returns.std()
    assert np.std(corrected(chance[:, 0], disturbances) - chance[:, 0]) < 0.3


def test_sets_of_disturbances_without_effect_are_seldom_corrected_for() -> None:
    rng = np.random.default_rng(0)
    returns = rng.standard_normal(60)
    changed = [not np.array_equal(corrected(returns, rng.standard_normal((60, 14))), returns) for _ in range(200)]
    assert 0.02 < np.mean(changed) < 0.2


def test_a_disturbance_far_from_0_is_known_as_well() -> None:
    """Such as a time of day, in seconds since 1970."""
    wind = np.random.default_rng(0).standard_normal((100, 1))
    np.testing.assert_allclose(corrected(wind[:, 0], 1.7e9 + 0.5 * wind), corrected(wind[:, 0], wind), atol=1e-3)


@pytest.mark.parametrize("constant", [0.0, 1e-300, -1e9])
def test_what_is_constant_changes_no_bit(constant: float) -> None:
    (returns, disturbances), constants = drawn(0), np.full((60, 2), constant)
    beside = np.hstack([disturbances, constants])
    assert corrected(returns, constants).tobytes() == returns.tobytes()
    assert corrected(returns, np.empty((60, 0))).tobytes() == returns.tobytes()
    assert corrected(constants[:, 0], disturbances).tobytes() == constants[:, 0].tobytes()
    assert corrected(returns, beside).tobytes() == corrected(returns, disturbances).tobytes()


def test_bounded_returns_by_hand() -> None:
    returns = np.append(np.arange(11.0), [-1000.0, -30.0])  # their outer deciles are -24 and 8.8
    assert bounded(returns).tolist() == pytest.approx([*range(11), -24.0 - 3 * 32.8, -30.0])
    assert bounded(np.array([1.0] * 20 + [-9.0])).tolist() == [1.0] * 20 + [-9.0]
    assert bounded(np.empty(0)).tolist() == []


def test_episodes_of_other_disturbances_are_not_blown_up() -> None:
    rng = np.random.default_rng(0)
    narrow, wide = rng.normal(0, 1e-3, (MOST_FITTED, 1)), rng.normal(0, 10, (100, 1))
    returns = np.concatenate([rng.normal(0, 1, 100), 1e3 * narrow[:, 0]])
    assert np.abs(corrected(returns, np.vstack([wide, narrow]))[:100]).max() < 10


def test_a_few_episodes_stay_as_they_are() -> None:
    returns, disturbances = drawn(0)
    few = FEWEST_EPISODES - 1
    assert corrected(returns[:few], disturbances[:few]).tobytes() == returns[:few].tobytes()
    assert (corrected(returns[: few + 1], disturbances[: few + 1]) != returns[: few + 1]).all()


@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_a_return_or_action_that_is_no_number_spoils_no_other(value: float) -> None:
    returns, disturbances = drawn(0)
    spoilt, others = returns.copy(), np.delete(np.arange(60), [3, 50])
    spoilt[[3, 50]] = value
    without = corrected(spoilt, disturbances)
    actions = np.where(np.isfinite(spoilt), 0.3, value)[:, None]
    np.testing.assert_array_equal(corrected_of_actions(returns, actions, disturbances)[others], without[others])
    np.testing.assert_array_equal(without[[3, 50]], value)
    np.testing.assert_allclose(without[others], corrected(returns[others], disturbances[others]))


def test_the_newest_of_many_are_fitted_and_all_are_corrected() -> None:
    returns, disturbances = drawn(0, MOST_FITTED + 500)
    without = corrected(returns, disturbances)
    assert without.mean() == pytest.approx(returns.mean()) and without[:500].std() < 0.5 * returns[:500].std()
    other = np.concatenate([-returns[:500], returns[500:]])
    np.testing.assert_array_equal(corrected(other, disturbances)[500:], without[500:])


def test_a_correction_is_made_once_after_an_addition(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: Any = []
    monkeypatch.setattr(buffers, "corrected", lambda *args: calls.append(len(args[0])) or corrected_of_actions(*args))
    buffer = played(30)
    for _ in range(3):
        buffer.sample(4)
        buffer.best_action()
        buffer.draw_near_best(0.1, 4)
    assert calls == [30]
    add(buffer, 30, (0, 0), 1.0, disturbances=[0.0, 0.0])
    buffer.best_action()
    assert calls == [30, 31]
