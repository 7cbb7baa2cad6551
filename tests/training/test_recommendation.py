"""What a training recommends after its episodes."""

import dataclasses
import math
from itertools import combinations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import RESULT

from sarah.control.parameters import Parameters
from sarah.episode.evaluation import Evaluation
from sarah.episode.tasks import STEPPING, Task
from sarah.errors import LearningError
from sarah.training.plan import Stage
from sarah.training.recommendation import DISTINCT, Tried, merit

CHOICE = (1.0, 1.0, 1.0, 1.0, 1.0)
WIDTH = 2.0
Tries = list[tuple[Parameters, float]]


def around(*centre: float, offset: float = 0.0) -> Parameters:
    return tuple(value + offset for value in centre)


def after(episodes: Tries, task: Task = STEPPING) -> Tried:
    """Episodes whose task names no disturbances."""
    tried = Tried(task)
    for parameters, worth in episodes:
        tried.append(parameters, worth)
    return tried


def distance(first: Parameters, second: Parameters) -> float:
    """Distance, in parameters scaled to [-1, 1]."""
    return 2.0 * math.dist(first, second) / WIDTH


def test_a_good_neighbourhood_beats_one_lucky_episode() -> None:
    lucky = (around(0.2, 0.2, 0.2, 0.2, 0.2), 0.92)
    centre = around(1.6, 1.6, 1.6, 1.6, 1.6)
    good = [(around(*centre, offset=0.01 * step), 0.85) for step in range(-2, 3)]
    unlucky = (around(0.2, 0.2, 0.2, 0.2, 0.25), 0.1)
    assert distance(after([lucky, unlucky, *good]).best(CHOICE), centre) < 0.02


@pytest.mark.parametrize("top", [(0.7, 1.3, 1.0, 0.9, 1.2), (2.0, 1.3, 1.0, 0.9, 1.2)])
def test_the_best_may_lie_between_episodes_and_at_an_end(top: Parameters) -> None:
    places = np.random.default_rng(0).uniform(0.0, WIDTH, (300, 5))
    near = [(tuple(map(float, place)), 1.0 - 0.5 * math.dist(place, top) ** 2 / WIDTH) for place in places]
    near = [(place, worth) for place, worth in near if worth > 0.3]
    best = after(near).best(CHOICE)
    assert distance(best, top) < min(distance(place, top) for place, _ in near)
    assert min(best) >= 0.0 and max(best) <= WIDTH


def test_what_known_disturbances_decide_is_no_merit() -> None:
    """Gentle pushes made one neighbourhood look good; hard ones struck the better one."""
    lucky, better = around(0.4, 0.4, 0.4, 0.4, 0.4), around(1.6, 1.6, 1.6, 1.6, 1.6)
    elsewhere = [(CHOICE, push) for push in np.linspace(-1.0, 1.0, 200).tolist()]
    knowing, ignorant = Tried(STEPPING), Tried(STEPPING)
    for place, push in [(lucky, -0.5), (better, 0.5)] * 10 + elsewhere:
        worth = 0.5 + 0.1 * (place == better) - 0.4 * push
        knowing.append(place, worth, (push,))
        ignorant.append(place, worth)
    assert knowing.best_of([lucky, better]) == better and ignorant.best_of([lucky, better]) == lucky


def test_disturbances_of_another_number_are_one_line() -> None:
    tried, words = Tried(STEPPING), r"^stepping: disturbances must be as many numbers in every episode, 2, not 1$"
    tried.append(CHOICE, 0.5, (1.0, 2.0))
    with pytest.raises(LearningError, match=words):
        tried.append(CHOICE, 0.5, (1.0,))
    assert len(tried) == 1


def test_what_failed_is_avoided() -> None:
    episodes = random_episodes(60)
    found: list[Parameters] = []
    for _ in range(3):
        found.append(after(episodes).best_simulated(found))
    assert {*found} < {parameters for parameters, _ in episodes}
    assert min(distance(*both) for both in combinations(found, 2)) >= DISTINCT
    assert after(episodes).best_of(found[::-1]) == found[0]


def test_where_the_best_expected_disappoints_another_is_tried() -> None:
    """A cliff beside the best makes the process promise too much beyond it."""
    episodes = [(around(*CHOICE, offset=0.02 * step), 0.9 if step < 5 else 0.1 * step) for step in range(10)]
    promised = after(episodes).best(CHOICE)
    found = after([*episodes, *[(promised, 0.5)] * 5]).best_simulated([])
    assert distance(found, promised) > 0.0 and dict(episodes)[found] >= 0.8


def test_distances_are_shares_of_the_box() -> None:
    tried = [(around(0.2, 0.5, 1.1, 0.3, 1.6, offset=0.02 * step), 0.1 * step) for step in range(8)]
    wider = [(tuple(2.0 * value for value in parameters), merit) for parameters, merit in tried]
    twice = tuple(dataclasses.replace(parameter, high=2.0 * parameter.high) for parameter in STEPPING.parameters)
    task = dataclasses.replace(STEPPING, parameters=twice)
    best = after(tried).best(CHOICE)
    assert after(wider, task).best(around(*CHOICE, offset=1.0)) == pytest.approx([2.0 * value for value in best])


def random_episodes(count: int) -> Tries:
    generator = np.random.default_rng(0)
    return [(tuple(map(float, generator.uniform(0, 2, 5))), float(generator.random())) for _ in range(count)]


@settings(max_examples=20)
@given(st.lists(st.tuples(st.tuples(*[st.floats(0, 2)] * 5), st.floats(0, 1)), max_size=20))
def test_whatever_was_tried_what_is_best_can_be_simulated(tried: Tries) -> None:
    best = after(tried).best(CHOICE)
    assert STEPPING.box.checked(best) == best and (tried or best == pytest.approx(CHOICE))
    for worth in (math.nan, math.inf, -math.inf, 1e308, -1e308):
        spoilt = [(parameters, worth if index % 2 else 0.5) for index, (parameters, _) in enumerate(tried)]
        assert all(map(math.isfinite, after(spoilt).best(CHOICE)))


def test_a_crest_is_found_though_single_episodes_say_little() -> None:
    """Merit falls with the distance from a place, and noise as large as the differences hides it: five trainings."""
    crest, found = np.full(3, 1.2), []
    for seed in range(5):
        generator = np.random.default_rng(seed)
        places = generator.uniform(0.4, 2.0, (200, 5))
        merits = 0.8 - 0.5 * np.linalg.norm(places[:, :3] - crest, axis=1) + generator.normal(scale=0.2, size=200)
        tried = [(tuple(map(float, place)), float(merit)) for place, merit in zip(places, merits, strict=True)]
        best = after(tried).best(CHOICE)
        luckiest, _ = max(tried, key=lambda episode: episode[1])
        found.append([np.linalg.norm(np.array(place[:3]) - crest) for place in (best, luckiest)])
    of_best, of_luckiest = np.mean(found, axis=0)
    assert of_best < 0.6 * of_luckiest


def test_a_long_training_is_judged_by_its_last_500_episodes() -> None:
    old, late = random_episodes(200), [(parameters, merit) for parameters, merit in random_episodes(700)[200:]]
    assert after([*old, *late]).best(CHOICE) == after(late).best(CHOICE)


def test_what_is_no_gait_has_less_merit() -> None:
    good = dataclasses.replace(RESULT, score=0.9, lifts_by_sensors=0.95)
    assert merit(good) == 0.9
    assert merit(dataclasses.replace(good, lifts_by_sensors=0.45)) == pytest.approx(0.45)
    assert merit(dataclasses.replace(good, sole_clearance=0.007)) == pytest.approx(0.63)
    assert merit(dataclasses.replace(good, shifts_by_sensors=0.0)) == 0.0
    budgets = [Stage(0, end).trial_episodes for end in (1, 24, 25, 49, 50, 1000)]
    assert budgets == [0, 0, 5, 5, 10, 10]  # a small one affords no trial


def scoring(*scores: float, **metrics: float) -> Evaluation:
    return Evaluation(tuple(dataclasses.replace(RESULT, score=score, **metrics) for score in scores))  # type: ignore[arg-type]


def test_what_chatters_or_is_no_gait_is_not_valid() -> None:
    still = Evaluation((RESULT,))
    dragging = scoring(0.95, 0.95, sole_clearance=0.0099)
    chattering = scoring(0.95, 0.95, vibration=2.5 * RESULT.vibration)
    assert not scoring(0.5, 0.9).shortcomings(True, still)
    assert dragging.shortcomings(True, still) and not dragging.shortcomings(False, still)
    assert not dataclasses.replace(dragging, least_clearance=0.005).shortcomings(True, still)
    assert chattering.shortcomings(True, still) and not chattering.shortcomings(True, None)  # nothing to compare with
