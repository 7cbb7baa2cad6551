"""A training is a function of its seed, to the last bit."""

import numpy as np
import pytest
from stable_baselines3.common.env_util import make_vec_env

from sarah.agents import NAF, PRESETS, LocalNAF


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
