"""A learner that is careful: a local Gaussian process, and trials that it believes to be safe and worth their price."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.stats import norm
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

from sarah.operation.settings import Parameters
from sarah.operation.shares import from_shares, to_shares
from sarah.sessions.learner import Operation


@dataclass(frozen=True)
class GaussianProcessSettings:
    """Settings of the Gaussian process and of its caution. Lengths and steps are shares of each parameter's range.

    :param length: length over which the reward changes
    :param deviation: standard deviation of the reward between far parameters
    :param noise: standard deviation of the reward of the same parameters
    :param step: standard deviation of a trial's changes from the best parameters
    :param share: share of the parameters that a trial changes
    :param candidates: number of candidates for each trial
    :param largest_loss: loss against the parameters of the beginning that a trial may risk, in reward
    :param caution: number of standard deviations by which it must be believed to lose less
    :param surprise: sum of standard deviations, beyond half a one for each window, by which rewards must fall short
        of what was expected before the robot counts as changed
    """

    length: float = 0.3
    deviation: float = 0.3
    noise: float = 0.05
    step: float = 0.08
    share: float = 0.5
    candidates: int = 200
    largest_loss: float = 0.15
    caution: float = 2.0
    surprise: float = 5.0


class LocalGaussianProcess:
    """Tries parameters near the best so far, by what a Gaussian process expects of them (Berkenkamp et al. 2016).

    A trial must be safe: its reward's lower bound is not far below the reward of the parameters it began with. And it
    must be worth its price: what it may bring in all windows that are left (expected improvement, Jones et al. 1998)
    is more than what it costs in its own. Otherwise the best parameters run on. When rewards fall short of what was
    expected (a cumulative sum, Page 1954), the robot has changed: what was learned before is forgotten.

    :param first: parameters to begin with
    :param seed: seed of the draws
    :param settings: lengths, deviations and caution
    """

    def __init__(
        self, first: Parameters, seed: int, settings: GaussianProcessSettings = GaussianProcessSettings()
    ) -> None:
        self._settings = settings
        self._generator = np.random.default_rng([seed, len(first)])
        kernel = ConstantKernel(settings.deviation**2) * Matern(settings.length, nu=2.5)
        self._model = GaussianProcessRegressor(kernel + WhiteKernel(settings.noise**2), optimizer=None)
        self._mean = 0.0
        self._start = to_shares(first)
        self._tried: list[np.ndarray] = []
        self._rewards: list[float] = []
        self._shortfall = 0.0
        self._windows_of_shortfall = 0

    def operate(self, robot: Operation) -> Parameters:
        """Try, and run on with the best."""
        shares = self._start
        while not robot.is_over:
            window = robot.run(from_shares(shares))
            self._add(shares, window.observed_reward)
            shares = self._next(robot.windows_left)
        return from_shares(self._best()[0])

    def _add(self, shares: np.ndarray, reward: float) -> None:
        """Learn from a window, and forget the windows before a change."""
        if self._tried:
            mean, deviation = self._expected(shares[None])
            surprise = (mean[0] - reward) / np.hypot(deviation[0], self._settings.noise)
            self._shortfall = max(0.0, self._shortfall + surprise - 0.5)
            self._windows_of_shortfall = self._windows_of_shortfall + 1 if self._shortfall else 0
        self._tried.append(shares)
        self._rewards.append(reward)
        if self._shortfall > self._settings.surprise:
            self._forget(self._windows_of_shortfall)
        self._mean = float(np.mean(self._rewards[:3]))
        self._model.fit(np.array(self._tried), np.array(self._rewards) - self._mean)

    def _forget(self, kept: int) -> None:
        """Begin again where the robot is now.

        :param kept: number of the last windows that are of the changed robot
        """
        self._start = self._best()[0]
        self._tried, self._rewards = self._tried[-kept:], self._rewards[-kept:]
        self._shortfall, self._windows_of_shortfall = 0.0, 0

    def _expected(self, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Mean and standard deviation of the reward that the process expects, without the noise of a window."""
        mean, deviation = self._model.predict(places, return_std=True)
        return mean + self._mean, np.sqrt(np.maximum(deviation**2 - self._settings.noise**2, 1e-12))

    def _best(self) -> tuple[np.ndarray, float]:
        """Of the parameters that were tried, those with the highest expected reward, and that reward."""
        mean, _ = self._expected(np.array(self._tried))
        index = int(np.argmax(mean))
        return self._tried[index], float(mean[index])

    def _next(self, windows_left: float) -> np.ndarray:
        """Parameters of the next window: the trial that is worth most, or the best so far.

        :param windows_left: number of windows in which an improvement would pay
        """
        settings = self._settings
        best, reward = self._best()
        changes = self._generator.normal(0.0, settings.step, (settings.candidates, len(best)))
        changes *= self._generator.random(changes.shape) < settings.share
        places = np.clip(best + changes, 0.0, 1.0)
        mean, deviation = self._expected(places)
        lowest = self._expected(self._start[None])[0][0] - settings.largest_loss
        is_safe = mean - settings.caution * deviation >= lowest
        better = (mean - reward) / deviation
        improvement = (mean - reward) * norm.cdf(better) + deviation * norm.pdf(better)
        worth = np.where(is_safe, improvement * windows_left - (reward - mean), -np.inf)
        index = int(np.argmax(worth))
        return places[index] if worth[index] > 0.0 else best
