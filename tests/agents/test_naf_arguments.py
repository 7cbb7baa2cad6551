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


NUMBERS: list[tuple[type[NAF], str, list[Any]]] = [
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
NUMBERS += [
    (LocalNAF, "elite_share", [-0.1, 1.5]),
    (LocalNAF, "elite_std", [-0.1, math.inf]),
    (LocalNAF, "elite_draws", [0, 2.5, True]),
    (LocalNAF, "replay_buffer_kwargs temperature", [-1.0, math.inf]),
]


def refusal(name: str, value: object) -> str:
    said = re.escape(repr(value))
    return rf"^{re.escape(name)} must be a (whole )?number (from|above) -?[01]( to (1|0\.9))?, not {said}$"


@pytest.mark.parametrize(
    ("algorithm", "name", "value"),
    [(algorithm, name, value) for algorithm, name, values in NUMBERS for value in values],
)
def test_bad_numbers(algorithm, name, value):
    *outer, name = name.split()
    arguments = {"policy_kwargs": SMALL}
    arguments |= {outer[0]: {**arguments.get(outer[0], {}), name: value}} if outer else {name: value}
    with pytest.raises(ValueError, match=refusal(name, value)):
        algorithm("MlpPolicy", "Pendulum-v1", **arguments)


LISTS: list[tuple[str, Any, str]] = [
    ("net_arch", [8, 0], refusal("a width in net_arch['W']", 0)),
    ("net_arch", {"V": [8], "mu": [2.5], "L": []}, refusal("a width in net_arch['mu']", 2.5)),
    ("net_arch", {"W": 8, "mu": [], "L": []}, r"^net_arch\['W'\] must be a list of widths, not 8$"),
    ("net_arch", "64, 64", r"^net_arch must be a list of widths or a dict of lists, not '64, 64'$"),
    ("net_arch", dict(pi=[4]), r"W or V, mu and L and perhaps shared, not \['pi'\]$"),
    ("net_arch", dict(V=[4], W=[4], mu=[4], L=[4]), r"not \['L', 'V', 'W', 'mu'\]$"),
    ("squash_mu", "no", r"^squash_mu must be True or False, not 'no'$"),
    ("exploration_std", [0.1] * 3, r"^exploration_std must be one number, or .* has: \(2,\), not \(3,\)$"),
    ("exploration_std", np.array([0.1, -0.1]), r"^each of exploration_std must be a number from 0, not -0\.1$"),
    ("exploration_std", LinearSchedule(-0.1, 0.5, 0.5), refusal("exploration_std(1)", -0.1)),
    ("exploration_std", LinearSchedule(0.5, -0.1, 0.5), refusal("exploration_std(0)", -0.1)),
    ("range", ([-2, 1], [2, 1]), r"^every action must have a range, .* are \[-2.0, 1.0\], the highest \[2.0, 1.0\]$"),
    ("range", ([-3e38], [3e38]), r"^the range of every action must be finite, not \[-3\S+\] to \[3\S+\]$"),
]


@pytest.mark.parametrize(("name", "value", "said"), LISTS)
def test_bad_networks_deviations_and_actions(name, value, said):
    env = gym.make("Pendulum-v1")
    ends = value if name == "range" else ([-1, -1], [1, 1])
    env.action_space = gym.spaces.Box(*np.array(ends, np.float32))
    policy_kwargs = {name: value} if name in ("net_arch", "squash_mu") else {}
    others = {name: value} if name == "exploration_std" else {}
    with pytest.raises(ValueError, match=said):
        NAF("MlpPolicy", env, policy_kwargs=policy_kwargs, **others)


UNKNOWN: list[tuple[type[NAF], dict[str, Any], str, str]] = [
    (NAF, {"learning_rat": 1e-3}, "NAF", "learning_rat', did you mean 'learning_rate'[?]"),
    (NAF, {"net_arch": [8]}, "NAF", "net_arch': it goes into policy_kwargs"),
    (NAF, {"optimizer_kwargs": {}}, "NAF", "optimizer_kwargs': it goes into policy_kwargs"),
    (NAF, {"policy_kwargs": {"share_features_extractor": True}}, "NAFPolicy", "share_features_extractor': V, W, mu .*"),
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


def test_ends_of_the_ranges_are_allowed():
    elite: Any = dict(elite_share=np.float32(1.0), elite_std=0.0, elite_draws=np.int64(1))
    policy: Any = dict(policy_kwargs={**SMALL, "min_curvature": 0}, replay_buffer_kwargs={"temperature": 0})
    model = LocalNAF("MlpPolicy", "Pendulum-v1", tau=0, max_grad_norm=math.inf, exploration_std=0, **elite, **policy)
    schedules = (model.elite_share_schedule, model.elite_std_schedule, model.exploration_schedule)
    assert [schedule(0.5) for schedule in schedules] == [1.0, 0.0, 0.0]


def test_local_naf_has_the_arguments_of_naf_in_their_order():
    own, others = (list(signature(kind).parameters.items()) for kind in (LocalNAF, NAF))
    differ = {mine[0]: mine[1].default for mine, other in zip(own, others, strict=False) if mine != other}
    assert differ.keys() == {"gamma", "replay_buffer_class"} and differ["gamma"] == 0.0
    assert [name[:5] for name, _ in own[len(others) :]] == ["elite", "elite", "elite", "first"]


@pytest.mark.parametrize("value", [math.nan, 1e30])
def test_rewards_that_ruin_the_networks_end_the_training(value):
    env = gym.wrappers.TransformReward(gym.make("Pendulum-v1"), lambda _: value)
    with pytest.raises(ValueError, match=r"^the loss is (nan|inf), and the agent is lost: .* VecCheckNan"):
        NAF("MlpPolicy", env, learning_starts=30, policy_kwargs=SMALL, seed=0).learn(50)


def test_a_loaded_agent_is_judged_and_knows_no_best_action_yet(tmp_path):
    model = LocalNAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL)
    model.save(tmp_path / "naf")
    with pytest.raises(ValueError, match=refusal("elite_draws", 0)):
        LocalNAF.load(tmp_path / "naf", elite_draws=0)
    with pytest.raises(ValueError, match=refusal("elite_share(0)", 2.0)):
        LocalNAF.load(tmp_path / "naf", elite_share=LinearSchedule(0.5, 2.0, 0.5))
    with pytest.raises(ValueError, match=r"^the replay buffer is empty, so there is no best action"):
        LocalNAF.load(tmp_path / "naf", env=model.get_env()).replay_buffer.best_action()
    NAF("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL).save(tmp_path / "plain")
    with pytest.raises(ValueError, match=r"^LocalNAF needs a RankReplayBuffer, .* an agent of NAF has: NAF\.load"):
        LocalNAF.load(tmp_path / "plain")
    TD3("MlpPolicy", "Pendulum-v1", policy_kwargs=SMALL).save(tmp_path / "td3")
    with pytest.raises(ValueError, match=r"^the policy of NAF must be NAFPolicy or a subclass of it, not TD3Policy$"):
        NAF.load(tmp_path / "td3")
