"""A learner that is careful: a local Gaussian process, and only trials that it believes to be safe."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

from sarah.operation.settings import Parameters
from sarah.operation.window import Window
from sarah.sessions.learner import Operation
from sarah.sessions.searches import from_shares, to_shares


@dataclass(frozen=True)
class GaussianProcessSettings:
    """Settings of the Gaussian process and of its caution. Lengths and steps are shares of each parameter's range.

    :param length: length over which the reward changes
    :param deviation: standard deviation of the reward between far parameters
    :param noise: standard deviation of the reward of the same parameters
    :param step: standard deviation of a trial's changes from the best parameters
    :param share: share of the parameters that a trial changes
    :param candidates: number of candidates for each trial
    :param largest_loss: reward below that of the beginning which a trial must be believed not to lose
    :param caution: number of standard deviations by which it must be believed
    """

    length: float = 0.3
    deviation: float = 0.3
    noise: float = 0.05
    step: float = 0.08
    share: float = 0.5
    candidates: int = 200
    largest_loss: float = 0.15
    caution: float = 1.0


class LocalGaussianProcess:
    def __init__(self, first: Parameters, seed: int, settings: GaussianProcessSettings = GaussianProcessSettings()) -> None:
        self._settings = settings
        self._first = to_shares(first)
        self._generator = np.random.default_rng([seed, 1])
        self._tried: list[np.ndarray] = []
        self._rewards: list[float] = []
        s = settings
        kernel = ConstantKernel(s.deviation**2) * Matern(s.length, nu=2.5) + WhiteKernel(s.noise**2)
        self._model = GaussianProcessRegressor(kernel, optimizer=None)
        self.log=[]

    def operate(self, robot: Operation) -> Parameters:
        seconds = robot.config.settle_seconds + robot.config.measure_seconds
        shares = self._first
        while not robot.is_over:
            window = robot.run(from_shares(shares))
            self._surprise(shares, window)
            self._tried.append(shares)
            self._rewards.append(window.observed_reward)
            left = max(0.0, 60.0 * robot.config.minutes - robot.seconds) / seconds
            shares = self._next(left)
        return from_shares(self._best()[0])

    def _surprise(self, shares, window):
        pass

    def _fit(self):
        self._level = float(np.mean(self._rewards[:3]))
        X = np.array(self._tried); y = np.array(self._rewards)
        self._mean = self._level
        self._model.fit(X, y - self._mean)

    def _predict(self, places):
        mean, deviation = self._model.predict(places, return_std=True)
        variance = np.maximum(deviation**2 - self._settings.noise**2, 1e-12)
        return mean + self._mean, np.sqrt(variance)

    def _best(self):
        self._fit()
        places = np.array(self._tried)
        mean, dev = self._predict(places)
        i = int(np.argmax(mean - 0.0 * dev))
        return places[i], mean[i], dev[i]

    def _next(self, left):
        s = self._settings
        best, value, _ = self._best()
        g = self._generator
        changes = g.normal(0.0, s.step, (s.candidates, len(best)))
        changes *= g.random(changes.shape) < s.share
        places = np.clip(best + changes, 0.0, 1.0)
        mean, dev = self._predict(places)
        safe = mean - s.caution * dev >= self._level - s.largest_loss
        # what a trial may bring in all windows that are left, less what it costs in its own
        z = (mean - value) / dev
        gain = (mean - value) * norm.cdf(z) + dev * norm.pdf(z)
        worth = np.where(safe, gain * left - (value - mean), -np.inf)
        i = int(np.argmax(worth))
        self.log.append((bool(safe.any()), float(worth[i])))
        if worth[i] <= 0:
            return best
        return places[i]
