"""The searches of trainings: asked and told in turn, with episodes in flight."""

import numpy as np
import optuna
import pytest

from sarah.control.parameters import Box, Parameter, Parameters
from sarah.runs.agent_settings import AgentSettings, EvolutionSettings, settings_of
from sarah.training.optimisers import OPTIMISERS
from sarah.training.search import Search, Start

BEST = np.array([0.3, -0.4])
PLAIN = Start()


def box_of(dimensions: int) -> Box:
    """A box of parameters between 0 and 4."""
    return Box(tuple(Parameter(f"p{index}", 0.0, 4.0, "", "a number", "") for index in range(dimensions)))


def make_search(algo: str, settings: AgentSettings, dimensions: int, seed: int, start: Start = PLAIN) -> Search:
    return OPTIMISERS[algo](settings, box_of(dimensions), seed, start)


def episode(parameters: Parameters) -> float:
    return 1.0 - float(np.square(np.array(parameters) / 2.0 - 1.0 - BEST).sum())


def tried(algo: str, seed: int, episodes: int, in_flight: int = 3) -> tuple[list[Parameters], Parameters]:
    """Parameters tried, and the choice in the end."""
    search = make_search(algo, settings_of(algo)(), 2, seed)
    asked: list[Parameters] = []
    for told in range(episodes):
        while len(asked) < min(episodes, told + in_flight) and search.ready():
            asked.append(search.ask())
        search.tell(asked[told], episode(asked[told]))
    return asked, search.choice()


@pytest.mark.parametrize("algo", OPTIMISERS)
def test_searches_find_what_is_good_within_the_box(algo: str) -> None:
    """They repeat with their seed, and leave Optuna as talkative as before."""
    before = optuna.logging.get_verbosity()
    optuna.logging.set_verbosity(optuna.logging.ERROR)
    asked, choice = tried(algo, seed=1, episodes=20 if algo == "gp" else 40)
    assert optuna.logging.get_verbosity() == optuna.logging.ERROR
    optuna.logging.set_verbosity(before)
    assert all(box_of(2).checked(parameters) == parameters for parameters in (*asked, choice))
    assert episode(choice) > 0.9
    if algo != "random":
        late, early = (np.median([episode(parameters) for parameters in part]) for part in (asked[-10:], asked[:10]))
        assert late > early
    again, other = (tried(algo, seed, episodes=9)[0] for seed in (1, 2))
    assert again == asked[:9] != other


@pytest.mark.parametrize("population", [2, 13])
def test_a_generation_is_told_before_the_next_is_asked_for(population: int) -> None:
    search, generation = make_search("cma-es", EvolutionSettings(population=population), 2, 0), []
    while search.ready():
        generation.append(search.ask())
    assert len(generation) == population
    for parameters in generation:
        assert not search.ready()
        search.tell(parameters, episode(parameters))
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
                search.tell(oldest, sign * episode(oldest))
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
