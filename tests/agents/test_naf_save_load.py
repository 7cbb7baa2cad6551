"""What is saved comes back, and training goes on from it; a training is a function of its seed, to the last bit."""

import numpy as np
import pytest
import torch as th
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.utils import LinearSchedule

from sarah.agents import NAF, PRESETS, LocalNAF, MlpPolicy, RankReplayBuffer

SMALL = dict(learning_starts=20, batch_size=8, buffer_size=300, seed=0)
OBS = np.random.default_rng(0).normal(size=(10, 3)).astype(np.float32)


def updates(model):
    """Steps that the optimizer has made."""
    return int(next(iter(model.policy.optimizer.state.values()))["step"])


def assert_same_state(first, second):
    assert first.keys() == second.keys()
    for key, value in first.items():
        th.testing.assert_close(value, second[key], rtol=0, atol=0, msg=key)


def make_model(algorithm=NAF, **kwargs):
    arguments = {"policy_kwargs": dict(net_arch=dict(V=[16], mu=[8], L=[4])), **SMALL, **kwargs}
    return algorithm("MlpPolicy", "Pendulum-v1", **arguments)


def test_save_load(tmp_path):
    model = make_model(max_grad_norm=0.3, exploration_std=LinearSchedule(0.3, 0.1, 0.5)).learn(40)
    model.save(tmp_path / "model")
    loaded = NAF.load(tmp_path / "model", env=make_vec_env("Pendulum-v1"))
    np.testing.assert_array_equal(model.predict(OBS)[0], loaded.predict(OBS)[0])
    assert_same_state(model.policy.state_dict(), loaded.policy.state_dict())
    optimizer = loaded.policy.optimizer.state_dict()
    for key, state in model.policy.optimizer.state_dict()["state"].items():
        assert_same_state(state, optimizer["state"][key])
    assert (loaded.max_grad_norm, loaded.num_timesteps) == (0.3, 40)
    assert loaded.exploration_schedule(0.75) == pytest.approx(0.2)
    assert loaded.policy.q_net is loaded.q_net and loaded.policy.q_net_target is loaded.q_net_target
    loaded.learn(30, reset_num_timesteps=False)
    assert loaded.num_timesteps == 70 and updates(loaded) == updates(model) + 30


def test_arguments_and_environments_can_change_at_load(tmp_path):
    model = make_model().learn(30)
    model.save(tmp_path / "model")
    loaded = NAF.load(tmp_path / "model", exploration_std=0.7, learning_rate=1e-5)
    assert loaded.exploration_schedule(0.5) == 0.7 and loaded.lr_schedule(0.5) == 1e-5
    np.testing.assert_array_equal(loaded.predict(OBS)[0], model.predict(OBS)[0])
    loaded = NAF.load(tmp_path / "model", env=make_vec_env("Pendulum-v1", n_envs=3))
    assert loaded.learn(30).num_timesteps == 30


@pytest.mark.parametrize(("algorithm", "kwargs"), [(NAF, {}), (LocalNAF, PRESETS["one-step"])])
def test_replay_buffer(tmp_path, algorithm, kwargs):
    model = make_model(algorithm, **{**kwargs, **SMALL}).learn(30)
    model.save(tmp_path / "model")
    model.save_replay_buffer(tmp_path / "buffer")
    loaded = algorithm.load(tmp_path / "model", env=make_vec_env("Pendulum-v1"))
    assert loaded.replay_buffer.size() == 0
    loaded.load_replay_buffer(tmp_path / "buffer")
    assert type(loaded.replay_buffer) is type(model.replay_buffer)
    assert isinstance(loaded.replay_buffer, RankReplayBuffer) == (algorithm is LocalNAF)
    for name in ("observations", "next_observations", "actions", "rewards", "dones", "timeouts"):
        np.testing.assert_array_equal(getattr(loaded.replay_buffer, name), getattr(model.replay_buffer, name))
    # The same draws, and so the same updates
    for each in (model, loaded):
        each.set_random_seed(5)
        each.set_logger(model.logger)
        each.train(3, 16)
    assert_same_state(model.policy.state_dict(), loaded.policy.state_dict())


def test_policy_alone(tmp_path):
    model = make_model(policy_kwargs=dict(net_arch=[8], squash_mu=False, dropout=0.3, min_curvature=0.5)).learn(30)
    model.policy.save(tmp_path / "policy")
    loaded = MlpPolicy.load(tmp_path / "policy")
    np.testing.assert_array_equal(model.predict(OBS)[0], loaded.predict(OBS)[0])
    assert_same_state(model.policy.state_dict(), loaded.state_dict())


def trained_weights(algorithm: type[NAF], seed: int, n_envs: int) -> np.ndarray:
    preset = PRESETS["one-step"] if algorithm is LocalNAF else {}
    arguments = {**preset, "learning_starts": 40, "batch_size": 16, "buffer_size": 500}
    env = make_vec_env("Pendulum-v1", n_envs=n_envs, seed=seed)
    model = algorithm("MlpPolicy", env, seed=seed, **arguments).learn(46)
    return np.concatenate([model.policy.parameters_to_vector(), model.replay_buffer.actions.ravel()])


@pytest.mark.parametrize(("algorithm", "n_envs"), [(NAF, 1), (LocalNAF, 2)])
def test_same_seed_same_bits(algorithm, n_envs):
    first = trained_weights(algorithm, 7, n_envs)
    np.testing.assert_array_equal(first, trained_weights(algorithm, 7, n_envs))
    assert (first != trained_weights(algorithm, 8, n_envs)).any()


def test_save_load_of_local_naf(tmp_path):
    std = LinearSchedule(0.4, 0.2, 0.5)
    model = make_model(LocalNAF, elite_share=0.3, elite_std=std, elite_draws=4, first_action_centre=True).learn(30)
    model.save(tmp_path / "model")
    loaded = LocalNAF.load(tmp_path / "model", env=make_vec_env("Pendulum-v1"))
    assert (loaded.elite_draws, loaded.first_action_centre) == (4, True)
    assert loaded.elite_share_schedule(0.5) == 0.3 and loaded.elite_std_schedule(0.75) == pytest.approx(0.3)
    assert loaded.learn(30, reset_num_timesteps=False).num_timesteps == 60
