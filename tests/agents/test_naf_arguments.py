"""Bad values are refused at once, in one line that names the argument and the value."""

import math
import re

import gymnasium as gym
import numpy as np
import pytest
from stable_baselines3 import TD3
from stable_baselines3.common.env_util import make_vec_env
from stable_baselines3.common.utils import LinearSchedule

from sarah.agents import NAF, LocalNAF

SMALL = {"net_arch": [8]}
BAD = [
    (NAF, "gamma", [math.nan, -0.1, 2.0]),
    (NAF, "tau", [math.nan, -0.1, 0.0, 2.0]),
    (NAF, "n_steps", [0, -1, 1.5]),
    (NAF, "max_grad_norm", [0.0, -1.0, math.nan, "1", None]),
    (NAF, "batch_size", [0, -1, 2.5, None]),
    (NAF, "exploration_std", [-0.1, math.inf, math.nan, "0.1", None]),
    (NAF, "buffer_size", [0, 1.5]),
    (NAF, "learning_starts", [-1, "a"]),
    (NAF, "gradient_steps", [-2, 1.5]),
    (LocalNAF, "elite_share", [-0.1, 1.5, math.nan, None]),
    (LocalNAF, "elite_std", [-0.1, math.inf, None]),
    (LocalNAF, "elite_draws", [0, -3, 2.5, math.nan, True, None]),
]


def refusal(name: str, value: object) -> str:
    said = re.escape(repr(value))
    return rf"^{re.escape(name)} must be a (whole )?number (from|above) -?[01]( to (1|0\.9))?, not {said}$"


@pytest.mark.parametrize(
    ("algorithm", "name", "value"), [(algorithm, name, value) for algorithm, name, values in BAD for value in values]
)
def test_bad_values_of_the_algorithm(algorithm, name, value):
    with pytest.raises(ValueError, match=refusal(name, value)):
        algorithm("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL, **{name: value})


UNKNOWN = [
    (NAF, {"learning_rat": 1e-3}, "NAF", "learning_rat', did you mean 'learning_rate'[?]"),
    (LocalNAF, {"learning_rat": 1e-3}, "LocalNAF", "learning_rat', did you mean 'learning_rate'[?]"),
    (LocalNAF, {"elite_shar": 0.5}, "LocalNAF", "elite_shar', did you mean 'elite_share'[?]"),
    (NAF, {"elite_share": 0.5}, "NAF", "elite_share': only LocalNAF has it"),
    (NAF, {"net_arch": [8]}, "NAF", "net_arch': it goes into policy_kwargs"),
    (NAF, {"xyz": 1}, "NAF", "xyz', allowed are learning_rate, buffer_size, .*, seed, device"),
    (NAF, {"policy_kwargs": {"dropot": 0.1}}, "NAFPolicy", "dropot', did you mean 'dropout'[?]"),
    (NAF, {"policy_kwargs": {"lr": 0.1}}, "NAFPolicy", "lr', allowed are net_arch, .*, dropout, min_curvature"),
    (NAF, {"policy_kwargs": {"n_critics": 1}}, "NAFPolicy", "n_critics': targets take W, a mean, .*"),
]


@pytest.mark.parametrize(("algorithm", "arguments", "of", "said"), UNKNOWN)
def test_an_unknown_argument_gets_the_nearest_or_where_it_belongs(algorithm, arguments, of, said):
    with pytest.raises(TypeError, match=rf"^{of}\.__init__\(\) got an unexpected keyword argument '{said}$"):
        algorithm("MlpPolicy", "Pendulum-v1", **arguments)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("policy_delay", "there is no actor to delay, as mu is part of Q"),
        ("target_policy_noise", "targets take W or V of the next state, and neither needs an action to smooth"),
        ("target_noise_clip", "targets take W or V of the next state, and neither needs an action to smooth"),
        ("ent_coef", "mu is one action and has no entropy, and exploration_std sets how widely it explores"),
        ("exploration_fraction", "exploration is Gaussian noise, and exploration_std sets its width, .*"),
    ],
)
@pytest.mark.parametrize("algorithm", [NAF, LocalNAF])
def test_an_argument_of_another_algorithm_gets_the_reason_why_naf_has_none(algorithm, name, reason):
    with pytest.raises(TypeError, match=rf"unexpected keyword argument '{name}': {reason}$"):
        algorithm("MlpPolicy", "Pendulum-v1", **{name: 0.1})


@pytest.mark.parametrize("value", [-1.0, math.inf, math.nan, "4"])
def test_bad_values_of_replay_and_policy(value):
    with pytest.raises(ValueError, match=refusal("temperature", value)):
        LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL, replay_buffer_kwargs={"temperature": value})
    with pytest.raises(ValueError, match=refusal("min_curvature", value)):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={**SMALL, "min_curvature": value})


@pytest.mark.parametrize("value", [-0.1, 1.0, math.nan, "0.2"])
def test_bad_shares_of_units_to_leave_out(value):
    with pytest.raises(ValueError, match=refusal("dropout", value)):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={**SMALL, "dropout": value})


@pytest.mark.parametrize("width", [0, -8, 2.5, "8"])
def test_bad_widths_of_layers(width):
    with pytest.raises(ValueError, match=refusal("a width in net_arch['W']", width)):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={"net_arch": [8, width]})
    with pytest.raises(ValueError, match=refusal("a width in net_arch['mu']", width)):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={"net_arch": {"V": [8], "mu": [width], "L": []}})


@pytest.mark.parametrize("net_arch", [{"W": 8, "mu": [], "L": []}, {"W": None, "mu": [], "L": []}])
def test_layers_that_are_no_list(net_arch):
    with pytest.raises(ValueError, match=r"net_arch\['W'\] must be a list of widths, not (8|None)"):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={"net_arch": net_arch})


@pytest.mark.parametrize("ends", [(-0.1, 0.5), (0.5, 2.0)])
def test_schedules_are_judged_by_their_ends(ends):
    end, value = (1, ends[0]) if ends[0] < 0 else (0, ends[1])
    with pytest.raises(ValueError, match=refusal(f"elite_share({end})", value)):
        LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL, elite_share=LinearSchedule(*ends, 0.5))


def test_bad_values_at_load(tmp_path):
    LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL).save(tmp_path / "model")
    with pytest.raises(ValueError, match=refusal("elite_draws", 0)):
        LocalNAF.load(tmp_path / "model", env=make_vec_env("Pendulum-v1"), elite_draws=0)


def test_ends_of_the_ranges_are_allowed():
    model = LocalNAF(
        "MlpPolicy",
        "Pendulum-v1",
        max_grad_norm=math.inf,
        exploration_std=0,
        elite_share=np.float32(1.0),
        elite_std=0.0,
        elite_draws=np.int64(1),
        replay_buffer_kwargs={"temperature": 0},
        policy_kwargs={**SMALL, "min_curvature": 0},
    )
    schedules = (model.elite_share_schedule, model.elite_std_schedule, model.exploration_schedule)
    assert [schedule(0.5) for schedule in schedules] == [1.0, 0.0, 0.0]


@pytest.mark.parametrize("net_arch", [64, "64, 64"])
def test_layers_that_are_neither_list_nor_dict(net_arch):
    with pytest.raises(ValueError, match=rf"^net_arch must be a list of widths or a dict of lists, not {net_arch!r}$"):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={"net_arch": net_arch})


def test_what_is_neither_true_nor_false():
    with pytest.raises(ValueError, match=r"^squash_mu must be True or False, not 'no'$"):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={"squash_mu": "no"})


class NoRange(gym.ActionWrapper):
    """A second action, which can only be 1."""

    action_space = gym.spaces.Box(np.float32([-2, 1]), np.float32([2, 1]))

    def action(self, action):
        return action[:1]


def test_an_action_without_a_range_is_refused():
    said = r"^every action must have a range, but the lowest are \[-2.0, 1.0\], the highest \[2.0, 1.0\]$"
    with pytest.raises(ValueError, match=said):
        NAF("MlpPolicy", NoRange(gym.make("Pendulum-v1")))


class Endless(gym.ActionWrapper):
    """Bounds so far apart that the range between them is infinite."""

    action_space = gym.spaces.Box(-3e38, 3e38, (1,))

    def action(self, action):
        return action


def test_an_action_with_an_endless_range_is_refused():
    with pytest.raises(ValueError, match=r"^the range of every action must be finite, not \[-3\S+\] to \[3\S+\]$"):
        NAF("MlpPolicy", Endless(gym.make("Pendulum-v1")))


def test_the_file_of_another_algorithm_is_refused(tmp_path):
    TD3("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL).save(tmp_path / "td3")
    with pytest.raises(ValueError, match=r"^the policy of NAF must be NAFPolicy or a subclass of it, not TD3Policy$"):
        NAF.load(tmp_path / "td3")


class OneReward(gym.RewardWrapper):
    """A reward in the place of every tenth one."""

    def __init__(self, value: float):
        super().__init__(gym.make("Pendulum-v1"))
        self.value, self.steps = value, 0

    def reward(self, reward):
        self.steps += 1
        return self.value if self.steps % 10 == 0 else reward


@pytest.mark.parametrize("value", [math.nan, math.inf, 1e30])
def test_rewards_that_ruin_the_networks_end_the_training(value):
    with pytest.raises(ValueError, match=r"^the loss is (nan|inf), and the agent is lost: .* VecCheckNan"):
        NAF("MlpPolicy", OneReward(value), learning_starts=30, policy_kwargs=SMALL, seed=0).learn(100)


def test_a_loaded_agent_knows_no_best_action_yet(tmp_path):
    model = LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL)
    model.save(tmp_path / "naf")
    with pytest.raises(ValueError, match=r"^the replay buffer is empty, so there is no best action"):
        LocalNAF.load(tmp_path / "naf", env=model.get_env()).replay_buffer.best_action()
