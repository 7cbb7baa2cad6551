"""What searches ask for, and what a training recommends after its episodes."""

import dataclasses
import math
from itertools import combinations

import numpy as np
import optuna
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from laboratory import RESULT

from sarah.control.parameters import Box, Parameter, Parameters
from sarah.episode.evaluation import Evaluation
from sarah.episode.tasks import STEPPING, Task
from sarah.errors import TaskError
from sarah.runs.agent_settings import AgentSettings, EvolutionSettings, settings_of
from sarah.training.optimisers import OPTIMISERS
from sarah.training.plan import Stage
from sarah.training.recommendation import DISTINCT, Tried, merit
from sarah.training.search import Search, Start

BEST = np.array([0.3, -0.4])
PLAIN = Start()


def box_of(dimensions: int) -> Box:
    """A box of parameters between 0 and 4."""
    return Box(tuple(Parameter(f"p{index}", 0.0, 4.0, "", "a number", "") for index in range(dimensions)))


def make_search(algo: str, settings: AgentSettings, dimensions: int, seed: int, start: Start = PLAIN) -> Search:
    return OPTIMISERS[algo](settings, box_of(dimensions), seed, start)


def worth_of(parameters: Parameters) -> float:
    return 1.0 - float(np.square(np.array(parameters) / 2.0 - 1.0 - BEST).sum())


def searched(algo: str, seed: int, episodes: int, in_flight: int = 3) -> tuple[list[Parameters], Parameters]:
    """Parameters tried, and the choice in the end."""
    search = make_search(algo, settings_of(algo)(), 2, seed)
    asked: list[Parameters] = []
    for told in range(episodes):
        while len(asked) < min(episodes, told + in_flight) and search.ready():
            asked.append(search.ask())
        search.tell(asked[told], worth_of(asked[told]))
    return asked, search.choice()


@pytest.mark.parametrize("algo", OPTIMISERS)
def test_searches_find_what_is_good_within_the_box(algo: str) -> None:
    """They repeat with their seed, and leave Optuna as talkative as before."""
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    asked, choice = searched(algo, seed=1, episodes=20 if algo == "gp" else 40)
    assert optuna.logging.get_verbosity() == optuna.logging.ERROR
    optuna.logging.set_verbosity(before)
    assert all(box_of(2).checked(parameters) == parameters for parameters in (*asked, choice))
    assert worth_of(choice) > 0.9
    if algo != "random":
        late, early = (np.median([worth_of(parameters) for parameters in part]) for part in (asked[-10:], asked[:10]))
        assert late > early
    again, other = (searched(algo, seed, episodes=9)[0] for seed in (1, 2))
    assert again == asked[:9] != other


@pytest.mark.parametrize("population", [2, 13])
def test_a_generation_is_told_before_the_next_is_asked_for(population: int) -> None:
    search, generation = make_search("cma-es", EvolutionSettings(population=population), 2, 0), []
    while search.ready():
        generation.append(search.ask())
    assert len(generation) == population
    for parameters in generation:
        assert not search.ready()
        search.tell(parameters, worth_of(parameters))
    assert search.ready()


def test_the_first_generation_has_the_deviation_that_is_set() -> None:
    for deviation in (0.05, 0.2):
        search = make_search("cma-es", EvolutionSettings(deviation=deviation, population=500), 4, 0)
        actions = np.array([box_of(4).scaled(search.ask()) for _ in range(500)])
        assert actions.std() == pytest.approx(deviation, rel=0.05)


@pytest.mark.parametrize("first", [(2.0,) * 4, (0.0, 1.0, 2.5, 4.0)])
@pytest.mark.parametrize("algo", OPTIMISERS)
def test_the_first_parameters_are_those_that_are_given(algo: str, first: Parameters) -> None:
    search = make_search(algo, settings_of(algo)(), 4, 5, Start(first))
    assert search.ask() == pytest.approx(first) != search.ask()
    assert make_search(algo, settings_of(algo)(), 4, 5).ask() != pytest.approx(first)


@pytest.mark.parametrize("slots", [1, 4])
@pytest.mark.parametrize("algo", ["gp", "tpe"])
def test_a_model_chooses_from_the_end_of_the_warm_up_on(algo: str, slots: int) -> None:
    """Its choices follow from the returns, and the parameters of the warm-up do not."""
    warm_up = 8

    def asked(sign: float) -> list[Parameters]:
        search = make_search(algo, settings_of(algo)(), 2, 3, Start(warm_up=warm_up, slots=slots))
        tries: list[Parameters] = []
        for index in range(warm_up + 1):
            if index >= slots:
                oldest = tries[index - slots]
                search.tell(oldest, sign * worth_of(oldest))
            tries.append(search.ask())
        return tries

    good, bad = asked(1.0), asked(-1.0)
    assert good[:warm_up] == bad[:warm_up] and good[warm_up] != bad[warm_up]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("dimensions", [1, 20])
@pytest.mark.parametrize("algo", OPTIMISERS)
def test_any_returns_are_learned_from(algo: str, dimensions: int) -> None:
    """Two values, all equal, and as large as a float can be."""
    for return_of in (lambda x: float(x[0] > 2.0), lambda x: 0.0, lambda x: 1e300 * (x[0] - 2.0)):
        search = make_search(algo, settings_of(algo)(), dimensions, 0)
        for _ in range(10):
            search.tell(parameters := search.ask(), return_of(parameters))
        assert box_of(dimensions).checked(search.choice())


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
    with pytest.raises(TaskError, match=words):
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
    episodes = [(around(*CHOICE, offset=0.02 * step), 0.1 * step) for step in range(10)]
    promised = after(episodes).best(CHOICE)
    found = after([*episodes, *[(promised, 0.1)] * 5]).best_simulated([])
    assert promised[0] > episodes[-1][0][0] and dict(episodes)[found] >= 0.8


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
