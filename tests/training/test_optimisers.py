"""Black-box optimisers: asked and told in turn, with episodes in flight."""

import warnings
from collections.abc import Callable

import numpy as np
import optuna
import pytest

from sarah.runs.agent_settings import AgentSettings, EvolutionSettings, settings_of
from sarah.training.optimisers import OPTIMISERS, Optimiser, Start

BEST = np.array([0.3, -0.4])


PLAIN = Start()


def make_optimiser(algo: str, settings: AgentSettings, dimensions: int, seed: int, start: Start = PLAIN) -> Optimiser:
    """An optimiser of the table."""
    return OPTIMISERS[algo](settings, dimensions, seed, start)


def episode(action: np.ndarray) -> float:
    return 1.0 - float(np.square(action - BEST).sum())


def tried(algo: str, seed: int, episodes: int = 40, in_flight: int = 3) -> tuple[list[np.ndarray], np.ndarray]:
    """Actions tried, and the choice in the end."""
    optimiser = make_optimiser(algo, settings_of(algo)(), 2, seed)
    actions: list[np.ndarray] = []
    told = 0
    while told < episodes:
        if len(actions) < episodes and len(actions) - told < in_flight and optimiser.ready():
            actions.append(optimiser.ask())
        else:
            optimiser.tell(actions[told], episode(actions[told]))
            told += 1
    return actions, optimiser.choice()


@pytest.mark.parametrize("algo", OPTIMISERS)
def test_optimisers_find_what_is_good_within_the_box(algo: str) -> None:
    actions, choice = tried(algo, seed=1)
    assert (np.abs(actions) <= 1.0).all() and choice.shape == (2,)
    assert episode(choice) > 0.9
    if algo != "random":
        late, early = (np.median([episode(action) for action in part]) for part in (actions[30:], actions[:10]))
        assert late > early


@pytest.mark.parametrize("algo", OPTIMISERS)
def test_optimisers_repeat_with_their_seed(algo: str) -> None:
    first, second, other = (np.array(tried(algo, seed, episodes=16)[0]) for seed in (1, 1, 2))
    assert np.array_equal(first, second) and not np.array_equal(first, other)


@pytest.mark.parametrize("population", [2, 8, 13])
def test_a_generation_is_told_before_the_next_is_asked_for(population: int) -> None:
    optimiser = make_optimiser("cma-es", EvolutionSettings(population=population), 2, 0)
    generation = []
    while optimiser.ready():
        generation.append(optimiser.ask())
    assert len(generation) == population
    for action in generation:
        assert not optimiser.ready()
        optimiser.tell(action, episode(action))
    assert optimiser.ready()


def test_the_first_generation_of_cma_es_has_the_deviation_that_is_set() -> None:
    for deviation in (0.05, 0.2):
        optimiser = make_optimiser("cma-es", EvolutionSettings(deviation=deviation, population=500), 4, 0)
        actions = np.array([optimiser.ask() for _ in range(500)])
        assert actions.std() == pytest.approx(deviation, rel=0.05)


@pytest.mark.parametrize("algo", OPTIMISERS)
def test_the_first_action_is_the_centre_if_it_is_to_be(algo: str) -> None:
    optimiser = make_optimiser(algo, settings_of(algo)(), 4, 5, Start(at_centre=True))
    first, second = optimiser.ask(), optimiser.ask()
    assert not first.any() and second.any()
    assert make_optimiser(algo, settings_of(algo)(), 4, 5).ask().any()


@pytest.mark.parametrize("slots", [1, 4])
@pytest.mark.parametrize("algo", ["gp", "tpe"])
def test_a_model_chooses_from_the_end_of_the_warm_up_on(algo: str, slots: int) -> None:
    """Its choices follow from the returns, and the actions of the warm-up do not."""
    warm_up = 8

    def asked(sign: float) -> list[list[float]]:
        optimiser = make_optimiser(algo, settings_of(algo)(), 2, 3, Start(warm_up=warm_up, slots=slots))
        actions: list[np.ndarray] = []
        for index in range(warm_up + 1):
            if index >= slots:
                action = actions[index - slots]
                optimiser.tell(action, sign * episode(action))
            actions.append(optimiser.ask())
        return [action.tolist() for action in actions]

    good, bad = asked(1.0), asked(-1.0)
    assert good[:warm_up] == bad[:warm_up] and good[warm_up] != bad[warm_up]


@pytest.mark.parametrize("dimensions", [1, 20])
@pytest.mark.parametrize("algo", OPTIMISERS)
def test_any_returns_are_learned_from(algo: str, dimensions: int) -> None:
    """Two values, all equal, and as large as a float can be."""
    returns: list[Callable[[np.ndarray], float]] = [lambda x: float(x[0] > 0.0), lambda x: 0.0, lambda x: 1e300 * x[0]]
    for episode_return in returns:
        optimiser = make_optimiser(algo, settings_of(algo)(), dimensions, 0)
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            for _ in range(17):
                optimiser.tell(action := optimiser.ask(), episode_return(action))
        assert (np.abs(optimiser.choice()) <= 1.0).all()


def test_optuna_says_as_much_as_before() -> None:
    before = optuna.logging.get_verbosity()
    try:
        optuna.logging.set_verbosity(optuna.logging.WARNING)
        make_optimiser("tpe", settings_of("tpe")(), 2, 0)
        assert optuna.logging.get_verbosity() == optuna.logging.WARNING
    finally:
        optuna.logging.set_verbosity(before)
