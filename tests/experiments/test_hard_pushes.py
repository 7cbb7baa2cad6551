"""Differences of survivals of the same pushes, against values computed by hand."""

import pytest

from experiments.robot.hard_pushes import difference


def test_the_difference_counts_pushes_that_only_one_survives() -> None:
    """Of 98 pushes the first survives 9 that the other does not, and the other 3: middle 6 / 100, variance 12.64e-4."""
    ones, others = "s" * 9 + "l" * 3 + "s" * 86, "l" * 9 + "s" * 3 + "s" * 86
    found = list(difference(ones, others).values())
    assert found[0] == pytest.approx(6 / 98)
    error = ((13 - 0.36) / 100**2) ** 0.5
    assert found[1:] == pytest.approx((0.06 - 1.96 * error, 0.06 + 1.96 * error))


def test_equal_outcomes_leave_an_interval() -> None:
    """Nobody knows a difference exactly from 18 pushes: 0 +- 1.96 sqrt(1 / 20 / 20)."""
    assert tuple(difference("s" * 18, "s" * 18).values()) == pytest.approx((0.0, -1.96 / 20, 1.96 / 20))
