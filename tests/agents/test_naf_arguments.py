"""Bad values are refused at once, in one line that names the argument and the value."""

import math
import re
from inspect import signature
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from stable_baselines3 import TD3
from stable_baselines3.common.utils import LinearSchedule

from sarah.agents import NAF, LocalNAF

SMALL = {"net_arch": [8]}
BAD: list[tuple[type[NAF], str, list[Any]]] = [
    (NAF, "gamma", [math.nan, -0.1, 2.0]),
    (NAF, "tau", [-0.1, 2.0]),
    (NAF, "n_steps", [0, 1.5]),
    (NAF, "max_grad_norm", [0.0, math.nan, "1"]),
    (NAF, "batch_size", [0, 2.5, None]),
    (NAF, "exploration_std", [-0.1, math.inf, "lin_-1", "auto"]),
    (NAF, "buffer_size", [0, 1.5]),
    (NAF, "learning_starts", [-1, "a"]),
    (NAF, "gradient_steps", [-2, 1.5]),
    (NAF, "policy_kwargs min_curvature", [-1.0, math.nan]),
    (NAF, "policy_kwargs dropout", [-0.1, 1.0]),
]
BAD += [
    (LocalNAF, "elite_share", [-0.1, 1.5]),
    (LocalNAF, "elite_std", [-0.1, math.inf]),
    (LocalNAF, "elite_draws", [0, 2.5, True]),
    (LocalNAF, "replay_buffer_kwargs temperature", [-1.0, math.inf]),
]


def refusal(name: str, value: object) -> str:
    said = re.escape(repr(value))
    return rf"^{re.escape(name)} must be a (whole )?number (from|above) -?[01]( to (1|0\.9))?, not {said}$"


@pytest.mark.parametrize(
    ("algorithm", "name", "value"), [(algorithm, name, value) for algorithm, name, values in BAD for value in values]
)
def test_bad_numbers(algorithm, name, value):
    *outer, name = name.split()
    arguments = {"policy_kwargs": SMALL}
    arguments |= {outer[0]: {**arguments.get(outer[0], {}), name: value}} if outer else {name: value}
    with pytest.raises(ValueError, match=refusal(name, value)):
        algorithm("MlpPolicy", "Pendulum-v1", **arguments)


UNKNOWN: list[tuple[type[NAF], dict[str, Any], str, str]] = [
    (NAF, {"learning_rat": 1e-3}, "NAF", "learning_rat', did you mean 'learning_rate'[?]"),
    (NAF, {"net_arch": [8]}, "NAF", "net_arch': it goes into policy_kwargs"),
    (NAF, {"xyz": 1}, "NAF", "xyz', allowed are learning_rate, buffer_size, .*, seed, device"),
    (NAF, {"policy": "MlpPolicy", "env": "Pendulum-v1", "tua": 1}, "NAF", "tua', did you mean 'tau'[?]"),
    (NAF, {"policy_delay": 2}, "NAF", "policy_delay': there is no actor to delay, as mu is part of Q"),
    (NAF, {"policy_kwargs": {"dropot": 0.1}}, "NAFPolicy", "dropot', did you mean 'dropout'[?]"),
    (NAF, {"policy_kwargs": {"lr": 0.1}}, "NAFPolicy", "lr', allowed are net_arch, .*, dropout, min_curvature"),
    (NAF, {"policy_kwargs": {"n_critics": 1}}, "NAFPolicy", "n_critics': targets take W, a mean, .*"),
]
UNKNOWN += [
    (LocalNAF, {"elite_shar": 0.5}, "LocalNAF", "elite_shar', did you mean 'elite_share'[?]"),
    (NAF, {"elite_share": 0.5}, "NAF", "elite_share': only LocalNAF has it"),
    (LocalNAF, {"ent_coef": 0.1}, "LocalNAF", "ent_coef': mu is one action and has no entropy, .*"),
]


@pytest.mark.parametrize(("algorithm", "arguments", "of", "said"), UNKNOWN)
def test_an_unknown_argument_gets_the_nearest_or_its_place(algorithm, arguments, of, said):
    with pytest.raises(TypeError, match=rf"^{of}\.__init__\(\) got an unexpected keyword argument '{said}$"):
        algorithm("MlpPolicy", "Pendulum-v1", **arguments)


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("net_arch", [8, 0], refusal("a width in net_arch['W']", 0)),
        ("net_arch", {"V": [8], "mu": [2.5], "L": []}, refusal("a width in net_arch['mu']", 2.5)),
        ("net_arch", {"W": 8, "mu": [], "L": []}, r"^net_arch\['W'\] must be a list of widths, not 8$"),
        ("net_arch", "64, 64", r"^net_arch must be a list of widths or a dict of lists, not '64, 64'$"),
        ("squash_mu", "no", r"^squash_mu must be True or False, not 'no'$"),
    ],
)
def test_bad_arguments_of_the_policy(name, value, said):
    with pytest.raises(ValueError, match=said):
        NAF("MlpPolicy", "Pendulum-v1", policy_kwargs={name: value})


@pytest.mark.parametrize("ends", [(-0.1, 0.5), (0.5, 2.0)])
def test_schedules_are_judged_by_their_ends(ends):
    end, value = (1, ends[0]) if ends[0] < 0 else (0, ends[1])
    with pytest.raises(ValueError, match=refusal(f"elite_share({end})", value)):
        LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL, elite_share=LinearSchedule(ends[0], ends[1], 0.5))


def test_ends_of_the_ranges_are_allowed():
    elite: Any = dict(elite_share=np.float32(1.0), elite_std=0.0, elite_draws=np.int64(1))
    policy: Any = dict(policy_kwargs={**SMALL, "min_curvature": 0}, replay_buffer_kwargs={"temperature": 0})
    model = LocalNAF("MlpPolicy", "Pendulum-v1", tau=0, max_grad_norm=math.inf, exploration_std=0, **elite, **policy)
    schedules = (model.elite_share_schedule, model.elite_std_schedule, model.exploration_schedule)
    assert [schedule(0.5) for schedule in schedules] == [1.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("value", "said"),
    [
        ([0.1, 0.2, 0.3], r"exploration_std must be one number, or as many as an action has: \(2,\), not \(3,\)"),
        (np.array([0.1, -0.1]), r"each of exploration_std must be a number from 0, not -0\.1"),
    ],
)
def test_bad_deviations_by_dimension(value, said):
    env = gym.make("Pendulum-v1")
    env.action_space = gym.spaces.Box(-1, 1, (2,))
    with pytest.raises(ValueError, match=f"^{said}$"):
        NAF("MlpPolicy", env, exploration_std=value)


def test_the_signature_of_local_naf_shows_those_of_naf_in_their_order():
    own, others = (list(signature(kind).parameters.items()) for kind in (LocalNAF, NAF))
    differ = {mine[0]: mine[1].default for mine, other in zip(own, others, strict=False) if mine != other}
    assert differ.keys() == {"gamma", "replay_buffer_class"} and differ["gamma"] == 0.0
    assert [name[:5] for name, _ in own[len(others) :]] == ["elite", "elite", "elite", "first"]


@pytest.mark.parametrize(
    ("low", "high", "said"),
    [
        (
            [-2, 1],
            [2, 1],
            r"every action must have a range, but the lowest are \[-2.0, 1.0\], the highest \[2.0, 1.0\]",
        ),
        ([-3e38], [3e38], r"the range of every action must be finite, not \[-3\S+\] to \[3\S+\]"),
    ],
)
def test_actions_without_a_finite_range_are_refused(low, high, said):
    env = gym.make("Pendulum-v1")
    env.action_space = gym.spaces.Box(np.float32(low), np.float32(high))
    with pytest.raises(ValueError, match=f"^{said}$"):
        NAF("MlpPolicy", env)


class OneReward(gym.RewardWrapper):
    """A reward in the place of every tenth one."""

    def __init__(self, value: float):
        super().__init__(gym.make("Pendulum-v1"))
        self.value, self.steps = value, 0

    def reward(self, reward):
        self.steps += 1
        return self.value if self.steps % 10 == 0 else reward


@pytest.mark.parametrize("value", [math.nan, 1e30])
def test_rewards_that_ruin_the_networks_end_the_training(value):
    with pytest.raises(ValueError, match=r"^the loss is (nan|inf), and the agent is lost: .* VecCheckNan"):
        NAF("MlpPolicy", OneReward(value), learning_starts=30, policy_kwargs=SMALL, seed=0).learn(50)


def test_a_loaded_agent_is_judged_and_knows_no_best_action_yet(tmp_path):
    model = LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL)
    model.save(tmp_path / "naf")
    with pytest.raises(ValueError, match=refusal("elite_draws", 0)):
        LocalNAF.load(tmp_path / "naf", elite_draws=0)
    with pytest.raises(ValueError, match=r"^the replay buffer is empty, so there is no best action"):
        LocalNAF.load(tmp_path / "naf", env=model.get_env()).replay_buffer.best_action()
    NAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL).save(tmp_path / "plain")
    with pytest.raises(ValueError, match=r"^LocalNAF needs a RankReplayBuffer, .* an agent of NAF has: NAF\.load"):
        LocalNAF.load(tmp_path / "plain")
    TD3("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL).save(tmp_path / "td3")
    with pytest.raises(ValueError, match=r"^the policy of NAF must be NAFPolicy or a subclass of it, not TD3Policy$"):
        NAF.load(tmp_path / "td3")
