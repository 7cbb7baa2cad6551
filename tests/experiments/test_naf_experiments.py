"""What the page of standard tasks computes from the rows of trainings."""

import gymnasium as gym
import pytest
from pandas import DataFrame

from experiments.naf.standard_tasks import EXPLORATION_STD, OTHERS, agent, answer, ends, over_seeds
from sarah.agents import NAF


def course(algorithm: str, seed: int, *returns: float, task: str = "Hopper-v5") -> list[dict]:
    about = {"task": task, "algorithm": algorithm, "seed": seed}
    return [{**about, "steps": step, "return": value, "v_over_bound": 0.5} for step, value in enumerate(returns)]


def test_a_training_ends_with_the_mean_of_its_last_evaluations() -> None:
    rows = DataFrame([*course("NAF", 0, 9.0, 1.0, 2.0, 6.0), *course("NAF", 1, 0.0, 5.0, 5.0, 5.0)])
    assert ends(rows)["return"].tolist() == [3.0, 5.0]
    (found,) = over_seeds(ends(rows), "task", "algorithm").to_dict("records")
    assert (found["seeds"], found["return"], found["return_low"], found["return_high"]) == (2, 4.0, 3.0, 5.0)


def test_an_algorithm_is_ahead_where_its_worst_seed_is_above_the_best_of_the_other() -> None:
    returns = {"A": ((3.0, 5.0), (1.0, 2.0)), "B": ((1.0, 2.0), (3.0, 5.0)), "C": ((1.0, 4.0), (3.0, 5.0))}
    rows = [
        row
        for task, of_algorithms in returns.items()
        for algorithm, values in zip(("NAF", "TD3"), of_algorithms, strict=True)
        for seed, value in enumerate(values)
        for row in course(algorithm, seed, value, task=task)
    ]
    assert answer(DataFrame(rows)) == (
        "Every seed of NAF ends above every seed of TD3 on A; every seed of NAF ends below every seed of TD3 on B; the "
        "ranges of the seeds of NAF and TD3 overlap on C. V comes to 0.50 of its bound at most, on A."
    )


@pytest.mark.parametrize("name", [*EXPLORATION_STD, *OTHERS])
def test_an_agent_explores_with_the_noise_of_its_name(name: str) -> None:
    made = agent(name, gym.make("Pendulum-v1"), 0)
    if name in OTHERS:
        assert type(made) is OTHERS[name] and (made.action_noise is None) == (name == "SAC")
    else:
        assert isinstance(made, NAF) and made.exploration_std == EXPLORATION_STD[name]
