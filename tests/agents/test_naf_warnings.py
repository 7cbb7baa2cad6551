"""What NAF says of rewards and of values that it cannot learn from."""

import re
import warnings

import numpy as np
import pytest

from sarah.agents.naf_warnings import reward_warning, value_warning


@pytest.mark.parametrize(
    ("mean", "std", "said"),
    [
        (-6.0, 0.5, "far below 0, .* as reward [+] 6;"),
        (6.0, 0.5, "far above 0, .* as reward - 6;"),
        (-4.0, 0.5, None),
        (-12.0, 2.0, "far below 0"),
        (-8.0, 2.0, None),
        (0.0, 31.0, "deviation of 31 are large"),
        (0.0, 29.0, None),
    ],
)
def test_rewards_are_far_by_their_deviation_and_large_by_its_size(mean, std, said):
    text = reward_warning(mean + std * np.array([-1.0, 1.0, -1.0, 1.0, -1.0, 1.0], np.float32))
    assert text is None if said is None else re.search(said, text)


def test_a_few_rewards_say_nothing():
    assert reward_warning(np.full(4, -100.0)) is None
    assert reward_warning(np.full(5, -100.0)) is not None


@pytest.mark.parametrize("wrong", [np.inf, np.nan])
def test_what_is_no_number_is_for_the_loss_to_refuse(wrong):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert reward_warning(np.array([0.0, 0.0, 0.0, 0.0, wrong], np.float32)) is None


@pytest.mark.parametrize(
    ("bound", "has_w", "remedy"),
    [
        (100.0, True, "wider exploration_std or a lower learning_rate"),
        (100.0, False, "layers for W in place of V"),
        (0.5, True, "scale the rewards up"),
    ],
)
def test_the_remedy_of_values_that_run_away_is_one_that_is_left(bound, has_w, remedy):
    text = value_warning(largest=2.5 * bound, ceiling=bound, bound=bound, gamma=0.99, has_w=has_w)
    assert remedy in text and "by 1.5 times" in text
