"""How far scores of a race can be trusted."""

import math

import numpy as np
import pytest

from sarah.reports.uncertainty import best_known, difference, number_at, share_of, standard_error


def test_the_error_of_one_training_is_that_over_its_episodes() -> None:
    assert standard_error(np.array([[0.2, 0.4, 0.6, 0.8]])) == pytest.approx(math.sqrt(0.2 / 3 / 4))


def test_the_error_of_one_episode_is_that_over_the_trainings() -> None:
    assert standard_error(np.array([[0.2], [0.4], [0.9]])) == pytest.approx(math.sqrt(0.13 / 3))
    assert math.isnan(standard_error(np.array([[0.7]])))


def test_the_error_is_over_trainings_and_episodes_together() -> None:
    """Means of the trainings are 0.2 and 0.6, of the episodes 0.3, 0.3 and 0.6; what is left is 0.1 or 0.2 each."""
    scores = np.array([[0.2, 0.0, 0.4], [0.4, 0.6, 0.8]])
    of_trainings, of_episodes, rest = 3 * 0.08, 2 * 0.03, 0.04 / 2
    assert standard_error(scores) == pytest.approx(math.sqrt((of_trainings + of_episodes - rest) / 6))


def test_what_varies_less_than_the_rest_counts_as_not_at_all() -> None:
    """Episodes are alike on average: only the trainings' means, 0.3 and 0.5, say something."""
    scores = np.array([[0.2, 0.4], [0.6, 0.4]])
    assert standard_error(scores) == pytest.approx(math.sqrt(2 * 0.02 / 4))


def test_where_all_means_are_alike_the_rest_is_the_error() -> None:
    """Every score is 0.5 off: four squares of 0.25 over one degree of freedom, and four scores."""
    assert standard_error(np.array([[0.0, 1.0], [1.0, 0.0]])) == pytest.approx(math.sqrt(4 * 0.25 / 4))


def test_luck_that_two_algorithms_share_is_no_difference() -> None:
    luck = np.array([0.0, 0.3, 0.6])
    ours, theirs = np.array([luck + 0.3, luck + 0.1]), np.array([luck, luck])
    found, low, high = difference(ours, theirs)
    half = 12.706 * 0.1  # Student's factor for one degree of freedom; 0.3 and 0.1 have a standard error of 0.1
    assert found == pytest.approx(0.2)
    assert (low, high) == pytest.approx((0.2 - half, 0.2 + half), abs=1e-3)


def test_one_training_of_each_says_nothing_of_other_seeds() -> None:
    found, *ends = difference(np.array([[0.5, 0.7]]), np.array([[0.4, 0.4]]))
    assert found == pytest.approx(0.2) and all(map(math.isnan, ends))


def test_one_half_of_the_episodes_chooses_and_the_other_scores() -> None:
    """The first training is best in episodes 0 and 2, the second in 1 and 3: each is judged where it was not chosen."""
    scores = np.array([[0.9, 0.5, 0.7, 0.3], [0.2, 0.8, 0.4, 0.6]])
    assert best_known(scores) == pytest.approx(((0.5 + 0.3) / 2 + (0.2 + 0.4) / 2) / 2)


def test_the_best_of_the_first_episodes_is_chosen_by_all_others() -> None:
    """In episodes 0 and 1 the first is best, but the others choose the second for both."""
    scores = np.array([[0.9, 0.9, 0.1, 0.1], [0.5, 0.7, 0.9, 0.9]])
    assert best_known(scores, 2) == pytest.approx((0.5 + 0.7) / 2)


def test_a_single_episode_chooses_and_judges() -> None:
    assert best_known(np.array([[0.4], [0.6]])) == pytest.approx(0.6)


def test_a_share_of_a_reward_below_zero_is_further_below() -> None:
    assert share_of(0.8, 0.95) == pytest.approx(0.76)
    assert share_of(-1.0, 0.95) == pytest.approx(-1.05)


def test_the_interval_of_a_count_knows_the_luck_of_the_judge() -> None:
    """Of two equal trainings a dozen episodes find one 5 % better; the interval has both numbers."""
    lucky = np.array([0.9, 0.7] * 6)
    scores = np.array([lucky, lucky - [0.3, 0.0, 0.0, 0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    assert number_at(scores, np.array([False, True]), 0.95) == (0, 0, 1)
    assert number_at(scores, np.array([True, True]), 0.95, best=0.5) == (2, 2, 2)


def test_luck_that_all_trainings_share_does_not_widen_a_count() -> None:
    """Every episode is drawn for all trainings at once: what lifts one lifts the best as well."""
    luck = 0.3 * np.random.default_rng(0).normal(size=40)
    scores = np.array([0.8 + luck, 0.79 + luck, 0.4 + luck])
    assert number_at(scores, np.full(3, True), 0.95) == (2, 2, 2)
