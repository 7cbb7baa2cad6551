"""What the experiments on NAF make of returns, and the agents that they compare."""

import gymnasium as gym
import numpy as np
import pytest
import torch as th
from pandas import DataFrame
from pytest import approx
from stable_baselines3 import TD3
from torch import nn

from experiments.interquartile import improvement, interquartile_mean
from experiments.naf.learners import AS_GU, COMPARED, NO_PARTS, V_IN_TARGETS, WIDER, WITH_NAFS_SETTINGS, WITHOUT, agent
from experiments.naf.mujoco_tasks import FIVE, FULL, answer, figure, four_algorithms, long_runs, parts_answer
from experiments.naf.standard_tasks import answer as answer_of_ranges
from experiments.naf.standard_tasks import ends, over_seeds
from experiments.tables import NOTHING
from sarah.agents import NAF


def course(algorithm: str, seed: int, *returns: float, task: str = "Hopper-v5") -> list[dict]:
    about = {"task": task, "algorithm": algorithm, "seed": seed}
    return [{**about, "steps": step, "return": value, "v_over_bound": 0.5} for step, value in enumerate(returns)]


def test_a_training_ends_with_the_mean_of_its_last_evaluations() -> None:
    rows = DataFrame([*course("NAF", 0, 9.0, 1.0, 2.0, 6.0), *course("NAF", 1, 0.0, 5.0, 5.0, 5.0)])
    assert ends(rows)["return"].tolist() == [3.0, 5.0]
    (found,) = over_seeds(ends(rows), "task", "algorithm").to_dict("records")
    assert (found["seeds"], found["return"], found["return_low"], found["return_high"]) == (2, 4.0, 3.0, 5.0)


def test_who_is_ahead_has_every_seed_above_those_of_the_other() -> None:
    returns = {"A": ((3.0, 5.0), (1.0, 2.0)), "B": ((1.0, 2.0), (3.0, 5.0)), "C": ((1.0, 4.0), (3.0, 5.0))}
    rows = [
        row
        for task, of_algorithms in returns.items()
        for algorithm, values in zip(("NAF", "TD3"), of_algorithms, strict=True)
        for seed, value in enumerate(values)
        for row in course(algorithm, seed, value, task=task)
    ]
    assert answer_of_ranges(DataFrame(rows)) == (
        "Every seed of NAF ends above every seed of TD3 on A; every seed of NAF ends below every seed of TD3 on B; the "
        "ranges of the seeds of NAF and TD3 overlap on C. V comes to 0.50 of its bound at most, on A."
    )


def test_the_interquartile_mean_leaves_out_best_and_worst_seed() -> None:
    mean, low, high = interquartile_mean([3.0, -1000.0, 1.0, 2.0, 1000.0])
    assert mean == 2.0 and -1000.0 < low < 1.0 and 3.0 < high < 1000.0
    assert interquartile_mean([7.0] * 5) == (7.0, 7.0, 7.0)


def test_the_probability_of_improvement_is_a_mean_over_tasks() -> None:
    """Always above on the first task; on the second two of four pairs, and one tie."""
    middle, low, high = improvement([[5.0, 6.0], [1.0, 3.0]], [[1.0, 2.0], [1.0, 2.0]])
    assert middle == approx((1.0 + 2.5 / 4) / 2) and low < middle < high <= 1.0
    assert improvement([[1.0, 1.0]], [[2.0, 2.0]]) == (0.0, 0.0, 0.0)


def test_an_interval_of_five_seeds_holds_the_mean_in_nine_cases_of_ten_as_its_page_says() -> None:
    drawn = np.random.default_rng(0).standard_normal((300, 5))
    held = [low <= 0.0 <= high for _, low, high in map(interquartile_mean, drawn)]
    assert np.mean(held) == approx(0.9, abs=0.04)


def test_naf_is_above_by_its_interval_missing_seeds_are_not_compared() -> None:
    levels = {"HalfCheetah-v5": (5.0, 1.0), "Hopper-v5": (1.0, 5.0), "Walker2d-v5": (1.0, 1.0)}
    rows = [
        row
        for task, of_task in levels.items()
        for algorithm, level in zip(("NAF", "TD3"), of_task, strict=True)
        for seed in range(5)
        for row in course(algorithm, seed, level + 0.1 * seed, task=task)
    ]
    rows += [row for seed in range(4) for row in course("SAC", seed, 1.0, task="Hopper-v5")]
    said = answer(DataFrame(rows))
    assert said.startswith(
        "After 15,000 steps NAF is above TD3 on HalfCheetah-v5, and below TD3 on Hopper-v5, and not told apart from "
        "TD3 on Walker2d-v5. A seed of NAF is above one of TD3 with a probability of 0."
    )
    assert "Seeds are missing so far to compare SAC, DDPG. V comes to" in said


def test_a_table_says_how_many_seeds_there_are_so_far() -> None:
    rows = [row for seed in range(3) for row in course("NAF", seed, 1.0)]
    rows += [row for seed in range(5) for row in course("DDPG", seed, 1.0)]
    rows += course("TD3", 0, 1.0)
    cells = [line.split(" | ")[1:4] for line in four_algorithms(DataFrame(rows)).splitlines()[4:]]
    assert cells == [["NAF", "3 of 5 so far", "1.0"], ["TD3", "1 of 5 so far", "1.0"], ["DDPG", "5", "1.0"]]
    assert figure(DataFrame(course("NAF", 0, 1.0))).axes  # of a single training


def test_long_runs_stand_side_by_side() -> None:
    rows = DataFrame([*course("NAF", 5, 1.0, 3.0, task="Ant-v5"), *course("TD3", 5, 2.0, task="Ant-v5")])
    assert long_runs(rows).splitlines() == [
        "**Return along one long run of each algorithm on Ant-v5. V comes to 0.50 of its bound at most.**",
        "",
        "| steps | NAF | TD3 |",
        "| --- | --- | --- |",
        "| 0 | 1 | 2 |",
        f"| 1 | 3 | {NOTHING} |",
    ]


def test_naf_is_told_apart_from_variants_of_which_no_seed_is_missing() -> None:
    returns = {"NAF": 2.0, "NAF, no dropout": 1.0, "NAF, no pull": 2.0, "NAF, V in the targets": 3.0}
    rows = [row for name, value in returns.items() for seed in range(5) for row in course(name, seed, value)]
    told = "NAF is above 'NAF, no dropout' on Hopper-v5, below 'NAF, V in the targets' on Hopper-v5."
    assert parts_answer(DataFrame(rows)).startswith(told)
    assert parts_answer(DataFrame([*course("NAF", 0, 2.0), *course("NAF, no pull", 0, 1.0)])) == ""


def test_each_case_is_a_training_those_that_tell_most_first() -> None:
    cases = [tuple(case.values()) for case in FULL.cases()]
    assert len(cases) == len(set(cases))
    first = cases[: 3 * len(FIVE)]
    assert {task for task, _, _ in first} == set(FIVE) and {seed for _, _, seed in first} == {0}
    assert [algorithm for _, algorithm, seed in cases if seed == 5] == list(COMPARED)


NOISES = {"DDPG": "0.1", "TD3": "0.1", "TD3, NAF's settings": "0.3", "DDPG, NAF's settings": "0.3"}


@pytest.mark.parametrize("name", [*COMPARED, *WITH_NAFS_SETTINGS])
def test_an_agent_has_the_noise_of_its_documentation_or_of_naf(name: str) -> None:
    made = agent(name, gym.make("Pendulum-v1"), 0)
    noise = made.action_noise
    assert f"sigma=[{NOISES[name]}]" in str(noise) if name in NOISES else noise is None
    if name in WITH_NAFS_SETTINGS:
        own = naf("NAF")
        assert (made.tau, made.learning_rate, made.policy.net_arch) == (own.tau, own.learning_rate, [256, 256])
        assert NOISES.get(name, "0.3") == str(own.exploration_std)


def test_an_agent_is_the_same_after_others() -> None:
    """DDPG writes the number of its critics into the arguments that it is given."""
    agent("DDPG, NAF's settings", gym.make("Pendulum-v1"), 0)
    td3 = agent("TD3, NAF's settings", gym.make("Pendulum-v1"), 0)
    assert isinstance(td3, TD3) and len(td3.critic.q_networks) == 2


def naf(name: str) -> NAF:
    made = agent(name, gym.make("Pendulum-v1"), 0)
    assert isinstance(made, NAF)
    return made


def test_what_is_taken_out_or_wider_is_what_the_name_says() -> None:
    assert [name for name in WIDER if name != f"NAF, noise of {naf(name).exploration_std}"] == []
    nets = {name: naf(name).q_net for name in WITHOUT}
    observation, action = th.ones(2, 3), th.ones(2, 1)
    assert not nets[NO_PARTS].has_w and not naf(AS_GU).q_net.has_w
    in_targets = nets[V_IN_TARGETS]
    assert th.equal(in_targets.target_value(observation), in_targets.value(observation)) and in_targets.has_w
    assert not any(isinstance(layer, nn.LayerNorm) for layer in nets["NAF, no normalisation"].value_net)
    assert not nets["NAF, no pull"].all_values(observation, action).mu.requires_grad
    assert nets["NAF, W without weights"].all_values(observation, action).distance.tolist() == [[0.0], [0.0]]
