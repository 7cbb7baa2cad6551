"""What the experiment on tasks of known truth takes for the truth is true."""

import numpy as np
import pytest

from experiments.linear_quadratic import GAMMA, TASKS, LinearQuadratic

ROBOTS, STEPS = 2000, 1200


@pytest.mark.parametrize("name", TASKS)
def test_v_is_what_the_best_law_earns_also_where_it_is_cut_at_the_bounds(name: str) -> None:
    env = LinearQuadratic(TASKS[name], seed=0)
    generator = np.random.default_rng(1)
    states = generator.normal(0.0, 5.0 * env.task.noise, (ROBOTS, env.task.states))
    promised, earned, at_bounds = env.value(states).mean(), 0.0, []
    for step in range(STEPS):
        actions = env.mu(states)
        at_bounds.append((np.abs(actions) == 1.0).mean())
        costs = env.task.cost * np.square(states).sum(axis=1) + env.task.effort * np.square(actions).sum(axis=1)
        earned += GAMMA**step * (env.task.offset - costs.mean())
        noise = generator.normal(0.0, env.task.noise, states.shape)
        states = states @ env.a.T + actions @ env.b.T + noise
    assert earned == pytest.approx(promised, rel=0.005)
    assert np.mean(at_bounds) < 0.05
