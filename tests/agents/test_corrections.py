"""Corrected returns lack what known disturbances explain, and nothing else."""

import numpy as np
import pytest
from sklearn.linear_model import Ridge
from sklearn.pipeline import make_pipeline
from sklearn.preprocessing import PolynomialFeatures, StandardScaler

from sarah.agents.corrections import FEWEST_EPISODES, MOST_FITTED, PENALTY, bounded, corrected


def drawn(seed: int, number: int = 60, width: int = 3) -> tuple[np.ndarray, np.ndarray]:
    """Returns that disturbances decide in part, and the disturbances."""
    rng = np.random.default_rng(seed)
    disturbances = rng.uniform(-1.0, 3.0, (number, width))
    first, second, third = disturbances.T[:3]
    returns = 2.0 + (first + 1.0) * (second + 1.0) - third**2 + rng.normal(size=number)
    return returns, disturbances


def test_a_disturbance_of_two_values_by_hand() -> None:
    """Its square is constant, so one weight is left: n / (n + penalty) of the true one."""
    side = np.resize([1.0, -1.0], 40)
    without = corrected(7.0 + 3.0 * side, 5.0 + 0.1 * side[:, None])
    np.testing.assert_allclose(without, 7.0 + 3.0 * side * PENALTY / (40 + PENALTY), rtol=1e-12)


@pytest.mark.parametrize("seed", range(5))
def test_it_is_a_ridge_regression_on_squares_and_products(seed: int) -> None:
    """Whatever the units are."""
    returns, disturbances = drawn(seed)
    features = (StandardScaler(), PolynomialFeatures(2, include_bias=False), StandardScaler())
    explanation = make_pipeline(*features, Ridge(alpha=PENALTY)).fit(disturbances, returns)
    without = corrected(returns, disturbances)
    np.testing.assert_allclose(without, returns - explanation.predict(disturbances) + returns.mean(), rtol=1e-9)
    np.testing.assert_allclose(corrected(returns, disturbances[:, ::-1] * 1e200 + 3e200), without)
    np.testing.assert_allclose(corrected(1e200 * returns, disturbances), 1e200 * without)


@pytest.mark.parametrize("seed", range(5))
def test_many_that_explain_nothing_hide_none_that_do(seed: int) -> None:
    returns, disturbances = drawn(seed)
    chance = np.random.default_rng(9).normal(size=(60, 20))
    among = corrected(returns, np.hstack([chance, disturbances]))
    assert np.std(among - corrected(returns, disturbances)) < 0.4 * returns.std()
    assert np.std(corrected(chance[:, 0], disturbances) - chance[:, 0]) < 0.3


@pytest.mark.parametrize("constant", [0.0, 1e-300, -1e9])
def test_what_is_constant_changes_no_bit(constant: float) -> None:
    (returns, disturbances), constants = drawn(0), np.full((60, 2), constant)
    beside = np.hstack([disturbances, constants])
    assert corrected(returns, constants).tobytes() == returns.tobytes()
    assert corrected(returns, np.empty((60, 0))).tobytes() == returns.tobytes()
    assert corrected(constants[:, 0], disturbances).tobytes() == constants[:, 0].tobytes()
    assert corrected(returns, beside).tobytes() == corrected(returns, disturbances).tobytes()


def test_bounded_returns_by_hand() -> None:
    returns = np.append(np.arange(11.0), [-1000.0, -30.0])  # their outer deciles are -24 and 8.8
    assert bounded(returns).tolist() == pytest.approx([*range(11), -24.0 - 3 * 32.8, -30.0])
    assert bounded(np.array([1.0] * 20 + [-9.0])).tolist() == [1.0] * 20 + [-9.0]
    assert bounded(np.empty(0)).tolist() == []


def test_episodes_of_other_disturbances_are_not_blown_up() -> None:
    rng = np.random.default_rng(0)
    narrow, wide = rng.normal(0, 1e-3, (MOST_FITTED, 1)), rng.normal(0, 10, (100, 1))
    returns = np.concatenate([rng.normal(0, 1, 100), 1e3 * narrow[:, 0]])
    assert np.abs(corrected(returns, np.vstack([wide, narrow]))[:100]).max() < 10


def test_a_few_episodes_stay_as_they_are() -> None:
    returns, disturbances = drawn(0)
    few = FEWEST_EPISODES - 1
    assert corrected(returns[:few], disturbances[:few]).tobytes() == returns[:few].tobytes()
    assert (corrected(returns[: few + 1], disturbances[: few + 1]) != returns[: few + 1]).all()


@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_a_return_that_is_no_number_spoils_no_other(value: float) -> None:
    returns, disturbances = drawn(0)
    spoilt, others = returns.copy(), np.delete(np.arange(60), [3, 50])
    spoilt[[3, 50]] = value
    without = corrected(spoilt, disturbances)
    np.testing.assert_array_equal(without[[3, 50]], value)
    np.testing.assert_allclose(without[others], corrected(returns[others], disturbances[others]))


def test_the_newest_of_many_are_fitted_and_all_are_corrected() -> None:
    returns, disturbances = drawn(0, MOST_FITTED + 500)
    without = corrected(returns, disturbances)
    assert without.mean() == pytest.approx(returns.mean()) and without[:500].std() < 0.5 * returns[:500].std()
    other = np.concatenate([-returns[:500], returns[500:]])
    np.testing.assert_array_equal(corrected(other, disturbances)[500:], without[500:])
