"""Where the environment says what luck an episode had, the replay buffer judges its action by the rest."""

import pickle
from typing import Any

import gymnasium
import numpy as np
import pytest
from gymnasium import spaces
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.utils import set_random_seed
from stable_baselines3.common.vec_env import VecNormalize

from sarah.agents import LocalNAF, RankReplayBuffer, buffers
from sarah.agents.corrections import corrected

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
    return corrected(buffer.rewards[order, 0], buffer.disturbances[order])


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
    env.ret_rms.var = 4.0
    buffer = played(120, temperature=0.0)
    set_random_seed(0)
    plain = buffer.sample(50)
    set_random_seed(0)
    np.testing.assert_allclose(buffer.sample(50, env).rewards, plain.rewards / 2, rtol=1e-6)


def test_a_correction_is_made_once_after_an_addition(monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[int] = []
    monkeypatch.setattr(buffers, "corrected", lambda *args: calls.append(len(args[0])) or corrected(*args))
    buffer = played(30)
    for _ in range(3):
        buffer.sample(4)
        buffer.best_action()
        buffer.draw_near_best(0.1, 4)
    assert calls == [30]
    add(buffer, 30, (0, 0), 1.0, disturbances=[0.0, 0.0])
    buffer.best_action()
    assert calls == [30, 31]


AS_BEFORE = "a list of finite numbers as in the episodes before, 2 of them, not"
ALWAYS = "there in every episode or in none"


@pytest.mark.parametrize(
    ("before", "info", "words"),
    [
        ({"episodes": 3}, {"disturbances": (1.0,)}, f"{AS_BEFORE} (1.0,)"),
        ({"episodes": 3}, {"disturbances": (1.0, "a")}, f"{AS_BEFORE} (1.0, 'a')"),
        ({"episodes": 3}, {"disturbances": 3.0}, f"{AS_BEFORE} 3.0"),
        ({"episodes": 3}, {}, ALWAYS),
        ({"episodes": 3, "tells": False}, {"disturbances": [1.0]}, ALWAYS),
        ({"episodes": 0}, {"disturbances": [np.inf]}, "a list of finite numbers, not [inf]"),
    ],
)
def test_other_disturbances_than_before_are_refused(before: Any, info: dict[str, Any], words: str) -> None:
    buffer = played(**before)
    with pytest.raises(ValueError) as refused:
        add(buffer, 3, (0, 0), 1.0, **info)
    assert str(refused.value) == f'info["disturbances"] must be {words}' and buffer.size() == before["episodes"]


def test_after_a_reset_there_may_be_others_or_none() -> None:
    buffer = played(30)
    for number, info in enumerate(({"disturbances": np.zeros(5)}, {}, {"disturbances": []})):
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
