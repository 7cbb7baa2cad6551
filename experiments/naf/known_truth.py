"""Tasks whose truth is known: V, mu and the gap between V and Q of any action, in closed form.

Episodes end by a time limit only. In the linear-quadratic ones the best action is where its cost and its use balance: V
is quadratic and mu linear in the state, and Q is a parabola in the action. In the others an action costs nothing, and
which sign is of use changes with the state: Q is linear in the action, and the best one is always at the bounds.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, NamedTuple

import gymnasium as gym
import numpy as np
from gymnasium import spaces

GAMMA = 0.99


class KnownTask(gym.Env):
    """A task whose ``value``, ``mu`` and ``gap`` are known, and the ``curvature`` of Q, which is the same everywhere.

    :param observations: number of observations
    :param actions: number of actions
    :param seed: seed of its noise; the task itself is the same for every seed
    """

    steps_of_an_episode = 200

    def __init__(self, observations: int, actions: int, seed: int) -> None:
        self.observation_space = spaces.Box(-np.inf, np.inf, (observations,))
        self.action_space = spaces.Box(-1.0, 1.0, (actions,))
        self._generator = np.random.default_rng(seed)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[np.ndarray, dict]:
        """Begin near rest."""
        super().reset(seed=seed)
        self._state, self._steps = self.begin(), 0
        return self._state.astype(np.float32), {}

    def step(self, action: np.ndarray) -> tuple[np.ndarray, float, bool, bool, dict]:
        """One step."""
        self._state, reward = self.follow(self._state, np.asarray(action, float))
        self._steps += 1
        return self._state.astype(np.float32), float(reward), False, self._steps == self.steps_of_an_episode, {}


class Size(NamedTuple):
    """Numbers of a linear-quadratic task."""

    states: int
    actions: int
    decay: float = 0.95  # factor by which a state shrinks and turns at each step
    gain: float = 0.3  # effect of an action on the state
    noise: float = 0.1  # standard deviation of the state's
    cost: float = 0.5  # of the state's squared length
    effort: float = 0.5  # cost of the action's squared length
    offset: float = 1.0  # reward at rest
    reward_noise: float = 0.3  # standard deviation
    steps_of_an_episode: int = 200  # after which it is cut


class LinearQuadratic(KnownTask):
    """x' = A x + B u + noise, and a reward of offset - cost |x|^2 - effort |u|^2 + noise.

    :param size: its numbers
    :param seed: seed of its noise
    """

    def __init__(self, size: Size, seed: int) -> None:
        super().__init__(size.states, size.actions, seed)
        self._size, self.steps_of_an_episode = size, size.steps_of_an_episode
        fixed = np.random.default_rng(size.actions)
        self._a = size.decay * _rotation(size.states, fixed)
        self._b = size.gain * _rotation(size.states, fixed)[:, : size.actions] * np.linspace(1.0, 0.5, size.actions)
        self._solve()

    def _solve(self) -> None:
        """The best linear law, by iteration of the discounted Riccati equation."""
        size, a, b = self._size, self._a, self._b
        s, last = np.zeros((size.states, size.states)), np.inf
        while not np.allclose(s, last, rtol=1e-12, atol=0.0):
            last = s
            half_curvature = size.effort * np.eye(size.actions) + GAMMA * b.T @ s @ b
            law = GAMMA * np.linalg.solve(half_curvature, b.T @ s @ a)
            s = size.cost * np.eye(size.states) + GAMMA * a.T @ s @ (a - b @ law)
        self._cost_to_go, self._law, self._half_curvature = s, law, half_curvature
        self.curvature = float(2.0 * np.linalg.eigvalsh(half_curvature)[-1])
        self._at_rest = (size.offset - GAMMA * size.noise**2 * np.trace(s)) / (1.0 - GAMMA)

    def value(self, states: np.ndarray) -> np.ndarray:
        """V of states."""
        return self._at_rest - np.einsum("ni,ij,nj->n", states, self._cost_to_go, states)

    def mu(self, states: np.ndarray) -> np.ndarray:
        """The best actions, cut at their bounds."""
        return np.clip(-states @ self._law.T, -1.0, 1.0)

    def gap(self, states: np.ndarray, actions: np.ndarray) -> np.ndarray:
        """V - Q of actions; V is of the law that no bounds cut."""
        from_mu = actions + states @ self._law.T
        return np.einsum("ni,ij,nj->n", from_mu, self._half_curvature, from_mu)

    def begin(self) -> np.ndarray:
        """A first state, within a few steps' noise of rest."""
        return self._generator.normal(0.0, 5.0 * self._size.noise, self._size.states)

    def follow(self, states: np.ndarray, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The next states of one or several states, and the rewards."""
        size = self._size
        costs = size.cost * np.square(states).sum(axis=-1) + size.effort * np.square(actions).sum(axis=-1)
        rewards = size.offset - costs + self._generator.normal(0.0, size.reward_noise, states.shape[:-1])
        noise = self._generator.normal(0.0, size.noise, states.shape)
        return states @ self._a.T + actions @ self._b.T + noise, rewards


class Signs(KnownTask):
    """x' = A x + B (sign(y) u) + noise, y' = D y + noise, and a reward of c x + noise. Observed are x and y.

    :param actions: number of actions, of states x and of states y
    :param seed: seed of its noise
    """

    noise, y_noise, reward_noise = 0.1, 0.44, 0.3
    curvature = 0.0

    def __init__(self, actions: int, seed: int) -> None:
        super().__init__(2 * actions, actions, seed)
        fixed = np.random.default_rng(actions)
        self._a, self._d = 0.95 * _rotation(actions, fixed), 0.9 * _rotation(actions, fixed)
        self._b = 0.3 * _rotation(actions, fixed) * np.linspace(1.0, 0.5, actions)
        self._c = fixed.normal(size=actions) / np.sqrt(actions)
        # V = value_of_x x + constant, as x' is linear in x and the best action's use is the same everywhere
        self._value_of_x = np.linalg.solve(np.eye(actions) - GAMMA * self._a.T, self._c)
        self._slopes = GAMMA * self._b.T @ self._value_of_x
        self._constant = np.abs(self._slopes).sum() / (1.0 - GAMMA)

    def value(self, states: np.ndarray) -> np.ndarray:
        """V of states."""
        return states[:, : len(self._c)] @ self._value_of_x + self._constant

    def mu(self, states: np.ndarray) -> np.ndarray:
        """The best actions, all at their bounds."""
        return np.sign(states[:, len(self._c) :]) * np.sign(self._slopes)

    def gap(self, states: np.ndarray, actions: np.ndarray) -> np.ndarray:
        """V - Q of actions."""
        return (1.0 - self.mu(states) * actions) @ np.abs(self._slopes)

    def begin(self) -> np.ndarray:
        """A first state."""
        return self._generator.normal(0.0, np.repeat([5.0 * self.noise, 1.0], len(self._c)))

    def follow(self, states: np.ndarray, actions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The next states, and the rewards."""
        x, y = np.split(states, 2, axis=-1)
        rewards = x @ self._c + self._generator.normal(0.0, self.reward_noise, states.shape[:-1])
        next_states = np.concatenate([x @ self._a.T + (np.sign(y) * actions) @ self._b.T, y @ self._d.T], axis=-1)
        noise = np.repeat([self.noise, self.y_noise], len(self._c))
        return next_states + self._generator.normal(0.0, noise, states.shape), rewards


def _rotation(size: int, generator: np.random.Generator) -> np.ndarray:
    """A random orthogonal matrix."""
    q, r = np.linalg.qr(generator.normal(size=(size, size)))
    return q * np.sign(np.diag(r))


FAINT: dict[str, Any] = dict(gain=2.0, noise=3.0, cost=0.0002, effort=0.04, offset=0.5, reward_noise=0.1)
"""Numbers of tasks in which noise decides most of what follows, and states are large."""
DRIFTING: dict[str, Any] = dict(decay=1.0, noise=0.02, cost=0.3, effort=0.1, reward_noise=0.0, steps_of_an_episode=30)
"""Numbers of a task in which nothing pulls the state back, and episodes are cut long before 1 / (1 - gamma) steps."""
KNOWN_TASKS: dict[str, Callable[[int], KnownTask]] = {
    "two actions, clear": partial(LinearQuadratic, Size(2, 2)),
    "six actions, clear": partial(LinearQuadratic, Size(6, 6)),
    "two actions, faint": partial(LinearQuadratic, Size(6, 2, **FAINT)),
    "six actions, faint": partial(LinearQuadratic, Size(17, 6, **FAINT)),
    "three actions, drifting": partial(LinearQuadratic, Size(3, 3, **DRIFTING)),
    "two actions, at the bounds": partial(Signs, 2),
    "six actions, at the bounds": partial(Signs, 6),
}
"""Tasks by name, each made with a seed."""
