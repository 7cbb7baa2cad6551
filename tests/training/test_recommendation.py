"""Candidates for the comparison that ends a training."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from laboratory import RESULT

from sarah.episode.evaluation import Evaluation
from sarah.episode.result import EpisodeResult
from sarah.episode.tasks import STEPPING
from sarah.runs.config import TrainingConfig
from sarah.training.recommendation import DISTINCT, Tried, best_compared, expected_merits, merit

CHOICE = (1.0, 1.0, 1.0, 1.0, 1.0)
WIDTH = 2.0


def around(*centre: float, offset: float = 0.0) -> tuple[float, ...]:
    return tuple(value + offset for value in centre)


def test_the_choice_is_judged_by_the_episodes_around_it() -> None:
    assert Tried(STEPPING, []).best(CHOICE, 3) == [CHOICE]
    elsewhere, beside = around(0.5, 0.5, 0.5, 0.5, 0.5), around(*CHOICE, offset=0.01)
    assert Tried(STEPPING, [(elsewhere, 0.9)]).best(CHOICE, 2) == [elsewhere, CHOICE]
    tried = [(elsewhere, 0.5), (beside, 0.9), (around(*CHOICE, offset=-0.01), 0.9)]
    assert Tried(STEPPING, tried).best(CHOICE, 2) == [CHOICE, elsewhere]


def test_a_good_neighbourhood_beats_one_lucky_episode() -> None:
    lucky = (around(0.2, 0.2, 0.2, 0.2, 0.2), 0.92)
    good = [(around(1.6, 1.6, 1.6, 1.6, 1.6, offset=0.01 * step), 0.85) for step in range(5)]
    unlucky = (around(0.2, 0.2, 0.2, 0.2, 0.25), 0.1)
    (best,) = Tried(STEPPING, [lucky, unlucky, *good]).best(CHOICE, 1)
    assert best in [parameters for parameters, _ in good]


def test_candidates_keep_their_distance() -> None:
    near = [(around(1.6, 1.6, 1.6, 1.6, 1.6, offset=0.001 * step), 0.9) for step in range(5)]
    far = (around(0.3, 0.3, 0.3, 0.3, 0.3), 0.5)
    assert Tried(STEPPING, [*near, far]).best(CHOICE, 2)[1] == far[0]


def test_distances_are_shares_of_the_box() -> None:
    tried = [(around(0.2, 0.5, 1.1, 0.3, 1.6, offset=0.02 * step), 0.1 * step) for step in range(8)]
    wider = [(tuple(2.0 * value for value in parameters), merit) for parameters, merit in tried]
    chosen = Tried(STEPPING, tried).best(CHOICE, 4)
    twice = tuple(dataclasses.replace(parameter, high=2.0 * parameter.high) for parameter in STEPPING.parameters)
    task = dataclasses.replace(STEPPING, parameters=twice)
    assert Tried(task, wider).best(tuple(2.0 * value for value in CHOICE), 4) == [
        tuple(2.0 * value for value in parameters) for parameters in chosen
    ]


@given(st.lists(st.tuples(st.tuples(*[st.floats(0, 2)] * 5), st.floats(0, 1)), max_size=20), st.integers(1, 6))
def test_there_are_never_more_than_asked_for(tried: list[tuple[tuple[float, ...], float]], count: int) -> None:
    chosen = Tried(STEPPING, tried).best(CHOICE, count)
    assert 1 <= len(chosen) <= count
    assert all(
        sum((a - b) ** 2 for a, b in zip(first, second, strict=True)) >= (DISTINCT * WIDTH) ** 2 - 1e-9
        for index, first in enumerate(chosen)
        for second in chosen[:index]
    )


def random_episodes(count: int) -> list[tuple[tuple[float, ...], float]]:
    generator = np.random.default_rng(0)
    return [(tuple(map(float, generator.uniform(0, 2, 5))), float(generator.random())) for _ in range(count)]


def test_candidates_are_those_of_the_definition() -> None:
    """The mean of a Gaussian process with a length of 0.2 and noise of 1, computed by its eigenvectors."""
    episodes = random_episodes(80)
    places = np.array([CHOICE, *(parameters for parameters, _ in episodes)]) / WIDTH
    merits = np.array([merit for _, merit in episodes])
    covariances = np.exp(-0.5 * (np.linalg.norm(places[:, None] - places[1:], axis=2) / 0.2) ** 2)
    values, vectors = np.linalg.eigh(covariances[1:])
    weights = vectors @ ((vectors.T @ merits) / (values + 1.0))
    expected = covariances @ weights
    (best,) = Tried(STEPPING, episodes).best(CHOICE, 1)
    assert best == pytest.approx(tuple(places[np.argmax(expected)] * WIDTH))
    assert expected_merits(places[1:], merits, places) == pytest.approx(expected)


def test_a_crest_is_found_though_single_episodes_say_little() -> None:
    """Merit falls with the distance from a place, and noise as large as the differences hides it: ten trainings."""
    crest, found = np.full(3, 1.2), []
    for seed in range(10):
        generator = np.random.default_rng(seed)
        places = generator.uniform(0.4, 2.0, (200, 5))
        merits = 0.8 - 0.5 * np.linalg.norm(places[:, :3] - crest, axis=1) + generator.normal(scale=0.2, size=200)
        tried = [(tuple(map(float, place)), float(merit)) for place, merit in zip(places, merits, strict=True)]
        (best,) = Tried(STEPPING, tried).best(CHOICE, 1)
        luckiest, _ = max(tried, key=lambda episode: episode[1])
        found.append([np.linalg.norm(np.array(place[:3]) - crest) for place in (best, luckiest)])
    of_best, of_luckiest = np.mean(found, axis=0)
    assert of_best < 0.9 * of_luckiest


def test_untried_parameters_are_worth_no_more_than_the_lower_quartile() -> None:
    places, merits = np.zeros((4, 5)), np.array([-9.0, -2.0, -1.0, -1.0])
    (far,) = expected_merits(places, merits, np.full((1, 5), 9.0))
    assert far == pytest.approx(-3.75)
    (far,) = expected_merits(places, -merits, np.full((1, 5), 9.0))
    assert far == pytest.approx(0.0)


@pytest.mark.parametrize("merit", [math.nan, math.inf, -math.inf, 1e308, -1e308])
def test_merits_that_are_no_number_or_overflow_leave_a_choice(merit: float) -> None:
    tried = [(parameters, merit if index % 2 else 0.5) for index, (parameters, _) in enumerate(random_episodes(20))]
    (best,) = Tried(STEPPING, tried).best(CHOICE, 1)
    assert all(map(math.isfinite, best))


def test_a_long_training_is_judged_by_its_last_five_hundred_episodes() -> None:
    old, late = random_episodes(200), [(parameters, merit) for parameters, merit in random_episodes(700)[200:]]
    assert Tried(STEPPING, [*old, *late]).best(CHOICE, 3) == Tried(STEPPING, late).best(CHOICE, 3)


def test_what_is_no_gait_has_less_merit() -> None:
    good = dataclasses.replace(RESULT, score=0.9, lifts_by_sensors=0.95)
    assert merit(good) == 0.9
    assert merit(dataclasses.replace(good, lifts_by_sensors=0.45)) == pytest.approx(0.45)
    assert merit(dataclasses.replace(good, sole_clearance=0.007)) == pytest.approx(0.63)
    assert merit(dataclasses.replace(good, shifts_by_sensors=0.0)) == 0.0


def test_a_small_budget_affords_no_comparison() -> None:
    budgets = {count: TrainingConfig(episodes=count) for count in (1, 99, 160)}
    assert {count: budget.candidate_count for count, budget in budgets.items()} == {1: 1, 99: 1, 160: 3}
    assert {count: budget.compared_episodes for count, budget in budgets.items()} == {1: 0, 99: 0, 160: 15}


def compared(**candidates: list[EpisodeResult]) -> str:
    """Name of the candidate that a comparison chooses, beside a baseline that does not shake."""
    results = {(float(index),): found for index, found in enumerate(candidates.values())}
    return list(candidates)[int(best_compared(results, Evaluation((RESULT,)))[0])]


def scoring(*scores: float) -> list[EpisodeResult]:
    return [dataclasses.replace(RESULT, score=score) for score in scores]


def test_what_chatters_or_is_no_gait_comes_last() -> None:
    dragging = [dataclasses.replace(RESULT, score=0.95, sole_clearance=0.0099)] * 5
    chattering = [dataclasses.replace(RESULT, score=0.95, vibration=2.5 * RESULT.vibration)] * 5
    assert compared(dragging=dragging, chattering=chattering, valid=scoring(0.5) * 5) == "valid"
    assert best_compared({(0.0,): chattering, (1.0,): scoring(0.5) * 5}, None) == (0.0,)  # nothing to chatter against
    assert best_compared({(0.0,): dragging, (1.0,): scoring(0.5) * 5}, None, must_step=False) == (0.0,)


def test_the_first_candidate_stays_unless_another_is_clearly_better() -> None:
    first, better = scoring(0.9, 0.2, 0.9, 0.3, 0.9), scoring(0.92, 0.23, 0.91, 0.33, 0.92)
    assert compared(first=first, luckier=scoring(0.9, 0.9, 0.9, 0.2, 0.9)) == "first"
    assert compared(first=first, better=better) == "better"
    assert compared(first=first, better=better, luckier=scoring(*[0.95] * 5)) == "better"
    assert compared(first=first, better=better, best=scoring(1.0, 0.4, 1.0, 0.5, 1.0)) == "best"


def test_a_single_episode_or_none_is_no_clear_difference() -> None:
    assert compared(first=scoring(0.1), other=scoring(0.9)) == "first"
    assert compared(first=scoring(0.1), missing=[]) == "first"
