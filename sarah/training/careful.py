"""A search that is careful: a local Gaussian process, and trials that it believes to be safe and worth their price.

Its process is not the one of :mod:`sarah.agents.gaussian_process`, which chooses length and noise by the rewards: here
both are fixed, so that the first windows do not mislead it about what is safe.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.stats import norm
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

from sarah.control.parameters import Box, Parameters

LENGTH = 0.6
"""Length over which the reward changes, as a share of each parameter's range."""
DEVIATION = 0.3
"""Standard deviation of the reward between far parameters."""
NOISE = 0.03
"""Standard deviation of the reward of the same parameters."""
NOISE_OF_KNOWN = 0.1
"""Standard deviation of what another robot of the same kind was worth with the same parameters."""
ALMOST_NOTHING = 1e-10
"""Variance that keeps the process's matrix regular."""
PESSIMISM = 0.1
"""Reward by which parameters that nobody knows are expected to be worse than those of the beginning."""
STEP = 0.05
"""Standard deviation of a trial's changes from the best parameters, as a share of each parameter's range."""
SHARE = 0.5
"""Share of the parameters that a trial changes."""
CANDIDATES = 200
"""Number of candidates for each trial."""
HORIZON = 2.0
"""Number of windows in which an improvement pays: after that, another one would have been found."""
LARGEST_LOSS = 0.1
"""Loss against the parameters of the beginning that a trial may risk, in reward."""
CAUTION = 2.0
"""Number of standard deviations by which it must be believed to lose less."""
SURPRISE = 6.0
"""Sum of standard deviations, beyond half a one for each window, by which windows must fall short of what was expected
before the robot counts as changed."""
DISAPPOINTING = 2.0
"""Number of standard deviations below what was expected at which a reward disappoints. A window in which the robot did
not fall counts as no worse than that: it may be chance (bounded influence, Huber 1964)."""
SURPRISE_OF_FALL = 4.0
"""Largest number of standard deviations that a fall counts towards a change: a single one is none."""
NOISE_WINDOWS = 20
"""Number of the last windows that tell how far rewards differ from what was expected."""
LEAST_NOISE_WINDOWS = 5
"""Number of windows below which they tell nothing."""
DEVIATION_OVER_MEDIAN = 1.4826
"""Standard deviation of normal numbers around 0 over the median of their absolute values."""
MOST_WINDOWS = 500
"""Number of windows that are remembered: the last ones. The time that a choice takes grows with its third power."""


class CarefulSearch:
    """Tries parameters near the best so far, by what a Gaussian process expects of them (Berkenkamp et al. 2016).

    A trial must be safe: its reward's lower bound is not far below the reward of the parameters it began with. And it
    must be worth its price: what it may bring in the next windows (expected improvement, Jones et al. 1998) is more
    than what it costs in its own. Otherwise the best parameters run on. They also follow a trial that disappoints: to
    see whether the robot is as before. If window after window falls short of what was expected, it has changed (a
    cumulative sum, Page 1954). What was learned before is then forgotten. A robot that falls with the best parameters
    gets the first ones.

    :param box: ranges of the parameters
    :param seed: seed of the draws
    :param first: parameters to begin with
    :param known: parameters and rewards that others have had, which it believes a little until the robot changes
    :param length: length over which the reward changes, as a share of each parameter's range
    """

    def __init__(
        self,
        box: Box,
        seed: int,
        first: Parameters,
        known: Sequence[tuple[Parameters, float]] = (),
        length: float = LENGTH,
    ) -> None:
        self._box = box
        self._generator = np.random.default_rng([seed, len(first)])
        kernel = ConstantKernel(DEVIATION**2) * Matern(length, nu=2.5)
        self._kernel = kernel + WhiteKernel(NOISE**2)
        self._model = GaussianProcessRegressor(self._kernel, optimizer=None)
        self._known = [np.array(box.shares(parameters)) for parameters, _ in known]
        self._known_rewards = [reward for _, reward in known]
        self._floor = -math.inf
        self._mean = 0.0
        self._first = self._start = self._asked = np.array(box.shares(first))
        self._tried: list[np.ndarray] = []
        self._rewards: list[float] = []
        self._bounded: list[float] = []
        self._errors: list[float] = []
        self._shortfall = 0.0
        self._doubted = 0
        self._is_told, self._is_trial, self._disappoints, self._has_failed = True, False, False, False
        self.lost = 0.0
        """Reward by which the last window fell short of what was expected, if that is more than chance; else 0."""

    def ready(self) -> bool:
        """Not while parameters are being tried: the next ones depend on their reward."""
        return self._is_told

    def ask(self, left: float = math.inf) -> Parameters:
        """A trial if there is one, or else the best parameters; the first ones where those have let the robot fall."""
        self._is_told = self._is_trial = False
        if self._has_failed or not self._tried:
            self._asked = self._first
        elif self._disappoints or (trial := self._trial(max(0.0, left - 1.0))) is None:
            self._asked = self._best()[0]
        else:
            self._asked, self._is_trial = trial, True
        return self._box.at_shares(self._asked)

    def tell(self, parameters: Parameters, merit: float, fell: bool = False) -> None:
        """Learn from what was asked for last, and forget what was before a change.

        After a merit so low that it disappoints, the best parameters have to show that the robot is as before.
        """
        self._is_told = True
        self._has_failed = fell and not self._is_trial and self._asked is not self._first
        expected, spread = self._foreseen(self._asked) if self._tried else (merit, NOISE)
        surprise = (expected - merit) / spread
        self._disappoints = surprise > DISAPPOINTING
        self.lost = expected - merit if self._disappoints else 0.0
        counted = min(surprise, SURPRISE_OF_FALL if fell else DISAPPOINTING)
        self._shortfall = max(0.0, self._shortfall + counted - 0.5)
        self._doubted = self._doubted + 1 if self._disappoints or self._shortfall > 0.0 else 0
        if self._tried:
            self._errors = [*self._errors[1 - NOISE_WINDOWS :], abs(expected - merit)]
        self._tried.append(self._asked)
        self._rewards.append(merit)
        self._bounded.append(merit if fell else max(merit, expected - DISAPPOINTING * spread))
        if self._shortfall > SURPRISE:
            self._forget()
        del self._tried[:-MOST_WINDOWS], self._rewards[:-MOST_WINDOWS], self._bounded[:-MOST_WINDOWS]
        self._fit()

    def remember(self, parameters: Parameters, reward: float) -> None:
        """Learn from a window of before the search; the first ones are those of the parameters to begin with.

        :param parameters: parameters of the window
        :param reward: its reward
        """
        self._tried.append(np.array(self._box.shares(parameters)))
        self._rewards.append(reward)
        self._bounded.append(reward)
        self._fit()

    def stay_above(self, reward: float) -> None:
        """Risk no more than the usual loss against a reward that can be had otherwise.

        :param reward: reward of other parameters than those to begin with
        """
        self._floor = reward

    def choice(self) -> Parameters:
        """The best of what was tried."""
        return self._box.at_shares(self._best()[0] if self._tried else self._first)

    def _foreseen(self, shares: np.ndarray) -> tuple[float, float]:
        """Mean and standard deviation of a window's reward, as far as they can be known before it."""
        mean, deviation = self._expected(shares[None])
        return float(mean[0]), float(np.hypot(deviation[0], max(NOISE, self._usual_error())))

    def _usual_error(self) -> float:
        """Standard deviation of the last rewards from what was expected, by their median, which no fall moves."""
        if len(self._errors) < LEAST_NOISE_WINDOWS:
            return 0.0
        return DEVIATION_OVER_MEDIAN * float(np.median(self._errors))

    def _forget(self) -> None:
        """Begin again where the robot is now, with the windows since the first doubt."""
        self._start = self._best()[0]
        self._tried, self._rewards = self._tried[-self._doubted :], self._rewards[-self._doubted :]
        self._bounded = list(self._rewards)
        self._shortfall, self._doubted = 0.0, 0
        self._known, self._known_rewards, self._floor = [], [], -math.inf

    def _fit(self) -> None:
        beginning = float(np.mean(self._rewards[:3]))
        self._mean = beginning - PESSIMISM
        # How deep a robot fell says nothing of the slope where it walks; a cliff would make the process ring.
        rewards = np.maximum([*self._bounded, *self._known_rewards], beginning - 2.0 * LARGEST_LOSS)
        uncertain = np.repeat([ALMOST_NOTHING, NOISE_OF_KNOWN**2], [len(self._tried), len(self._known)])
        self._model = GaussianProcessRegressor(self._kernel, alpha=uncertain, optimizer=None)
        self._model.fit(np.array([*self._tried, *self._known]), rewards - self._mean)

    def _expected(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation of the reward that the process expects, without the noise of a window."""
        mean, deviation = self._model.predict(places, return_std=True)
        return mean + self._mean, np.sqrt(np.maximum(deviation**2 - NOISE**2, 1e-12))

    def _best(self) -> tuple[np.ndarray, float]:
        """Of the parameters that were tried, those with the highest expected reward, and that reward."""
        mean, _ = self._expected(np.array(self._tried))
        index = int(np.argmax(mean))
        return self._tried[index], float(mean[index])

    def _trial(self, windows_left: float) -> np.ndarray | None:
        """Parameters to try that are worth it and safe, if there are any.

        :param windows_left: number of windows after the trial, in which an improvement would pay
        """
        best, reward = self._best()
        changes = self._generator.normal(0.0, STEP, (CANDIDATES, len(best)))
        changes *= self._generator.random(changes.shape) < SHARE
        places = np.clip(best + changes, 0.0, 1.0)
        mean, deviation = self._expected(places)
        lowest = max(self._expected(self._start[None])[0][0], self._floor) - LARGEST_LOSS
        is_safe = mean - CAUTION * deviation >= lowest
        better = (mean - reward) / deviation
        improvement = (mean - reward) * norm.cdf(better) + deviation * norm.pdf(better)
        worth = np.where(is_safe, improvement * min(windows_left, HORIZON) - (reward - mean), -np.inf)
        index = int(np.argmax(worth))
        return places[index] if worth[index] > 0.0 else None
