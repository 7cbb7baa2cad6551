"""What the pages of NAF compute from the rows of trainings."""

import gymnasium as gym
import pytest
from pandas import DataFrame

from experiments.naf import known_tasks, standard_tasks
from experiments.naf.algorithms import OTHERS, VARIANTS, agent


def course(algorithm: str, seed: int, *returns: float, task: str = "Hopper-v5") -> list[dict]:
    about = {"task": task, "algorithm": algorithm, "seed": seed}
    return [{**about, "steps": step, "return": value, "v_over_bound": 0.5} for step, value in enumerate(returns)]


def test_a_training_ends_with_the_mean_of_its_last_evaluations() -> None:
    rows = DataFrame([*course("NAF", 0, 9.0, 1.0, 2.0, 6.0), *course("NAF", 1, 0.0, 5.0, 5.0, 5.0)])
    assert standard_tasks.ends(rows)["return"].tolist() == [3.0, 5.0]
    (found,) = standard_tasks.over_seeds(standard_tasks.ends(rows), "task", "algorithm").to_dict("records")
    assert (found["seeds"], found["return"], found["return_low"], found["return_high"]) == (2, 4.0, 3.0, 5.0)


def test_an_algorithm_is_ahead_where_its_worst_seed_is_above_the_best_of_the_other() -> None:
    ends = {"A": ((3.0, 5.0), (1.0, 2.0)), "B": ((1.0, 2.0), (3.0, 5.0)), "C": ((1.0, 4.0), (3.0, 5.0))}
    rows = [
        row
        for task, of_algorithms in ends.items()
        for algorithm, values in zip(("NAF", "TD3"), of_algorithms, strict=True)
        for seed, value in enumerate(values)
        for row in course(algorithm, seed, value, task=task)
    ]
    assert standard_tasks.answer(DataFrame(rows)) == (
        "Every seed of NAF ends above every seed of TD3 on A; every seed of NAF ends below every seed of TD3 on B; the "
        "ranges of the seeds of NAF and TD3 overlap on C. V comes to 0.50 of its bound at most, on A."
    )


def test_statistics_of_seeds_leave_out_tasks_that_lack_the_column() -> None:
    rows = [("a", "NAF", 1.0), ("a", "NAF", 4.0), ("a", "DDPG", 2.0), ("b", "NAF", None)]
    found = known_tasks.of_seeds(DataFrame(rows, columns=["task", "algorithm", "score"]), "score", "max")
    assert found.to_dict("index") == {"a": {"NAF": 4.0, "DDPG": 2.0}}


@pytest.mark.parametrize("name", [*VARIANTS, *OTHERS])
def test_an_algorithm_has_the_layers_of_its_class_unless_others_are_given(name: str) -> None:
    env = gym.make("Pendulum-v1")
    layers = [list(agent(name, env, 0, given).policy.parameters()) for given in (None, [8, 8])]
    widest = [max(max(layer.shape) for layer in of_one) for of_one in layers]
    assert widest[0] in (256, 400) and widest[1] == 8
