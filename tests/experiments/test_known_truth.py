"""What the tasks of known truth say is true is true."""

import numpy as np
import pytest

from experiments.naf.known_truth import GAMMA, KNOWN_TASKS, KnownTask

ROBOTS, STEPS = 2000, 1200
INSIDE = [name for name in KNOWN_TASKS if "bounds" not in name]
"""Tasks whose best action is seldom at the bounds, which the equations leave out."""


def first_states(task: KnownTask, count: int) -> np.ndarray:
    return np.stack([task.begin() for _ in range(count)])


@pytest.mark.parametrize("name", KNOWN_TASKS)
def test_v_is_what_the_best_law_earns_also_where_it_is_cut_at_the_bounds(name: str) -> None:
    task = KNOWN_TASKS[name](0)
    states = first_states(task, ROBOTS)
    promised, earned, at_bounds = task.value(states).mean(), 0.0, []
    for step in range(STEPS):
        actions = task.mu(states)
        at_bounds.append((np.abs(actions) == 1.0).mean())
        states, rewards = task.follow(states, actions)
        earned += GAMMA**step * rewards.mean()
    assert earned == pytest.approx(promised, rel=0.005)
    assert np.mean(at_bounds) < 0.05 or name not in INSIDE


@pytest.mark.parametrize("name", KNOWN_TASKS)
def test_an_action_loses_the_gap(name: str) -> None:
    """Bellman's equation of Q = V - gap, in the mean of many draws of the noise."""
    task = KNOWN_TASKS[name](0)
    generator = np.random.default_rng(1)
    for state in first_states(task, 3):
        action = generator.uniform(-1.0, 1.0, task.action_space.shape)
        states, actions = np.tile(state, (100_000, 1)), np.tile(action, (100_000, 1))
        next_states, rewards = task.follow(states, actions)
        outcomes = rewards + GAMMA * task.value(next_states)
        expected = task.value(states[:1]) - task.gap(states[:1], actions[:1])
        assert outcomes.mean() == pytest.approx(expected[0], abs=5.0 * outcomes.std() / 100_000**0.5)


@pytest.mark.parametrize("name", KNOWN_TASKS)
def test_the_best_action_has_no_gap_and_curvature_is_that_of_the_gap(name: str) -> None:
    task = KNOWN_TASKS[name](0)
    states = 0.1 * first_states(task, 1)
    best = task.mu(states)
    assert task.gap(states, best) == pytest.approx(0.0, abs=1e-9)
    directions = np.random.default_rng(0).normal(size=(20_000, *task.action_space.shape))
    steps = 0.1 * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    before, at, after = (task.gap(states, best + sign * steps) for sign in (-1.0, 0.0, 1.0))
    steepest = ((before - 2 * at + after) / 0.1**2).max()
    assert steepest == pytest.approx(task.curvature, rel=0.1, abs=1e-9) and steepest <= task.curvature + 1e-6
