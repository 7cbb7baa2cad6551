"""Any legal settings, parameters and seed give an episode that ends, and numbers."""

import math

from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control import constants
from sarah.control.constants import ControllerConstants
from sarah.envs.sarah_env import observation_from
from sarah.episode import push
from sarah.episode.ending import TERMINATIONS
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import begin_episode
from sarah.simulation import randomisation, terrain
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

PLAUSIBLE = {**randomisation.PLAUSIBLE, **terrain.PLAUSIBLE, **push.PLAUSIBLE, **constants.PLAUSIBLE}
P = st.tuples(*[st.floats(0.0, 2.0)] * 5)
V = st.tuples(*[st.floats(-2.0, 2.0)] * 4)


def plausible(name: str) -> st.SearchStrategy[float]:
    """Anything from end to end of what is allowed, the ends above all."""
    low, high, _ = PLAUSIBLE[name]
    return st.sampled_from([low, high]) | st.floats(low, high)


def plausible_range(name: str) -> st.SearchStrategy[tuple[float, ...]]:
    return st.tuples(plausible(name), plausible(name)).map(lambda ends: tuple(sorted(ends)))


RANGES = ("friction", "actuator_bandwidth")
CONFIG = st.builds(
    BalanceConfig,
    physics=st.sampled_from([Physics(50, 1, 50), Physics(100, 1), Physics(300, 200), Physics(2000, 1, 1000)]),
    randomisation=st.builds(
        Randomisation,
        **{name: plausible_range(name) if name in RANGES else plausible(name) for name in randomisation.PLAUSIBLE},
    ),
    terrain=st.builds(Terrain, **{name: plausible_range(name) for name in terrain.PLAUSIBLE}),
    controller=st.builds(ControllerConstants, **{name: plausible(name) for name in constants.PLAUSIBLE}),
    time_limit=st.sampled_from([1.1, 1.5]),
    reward_form=st.sampled_from(["symmetric", "printed"]),
    stepping=P,
    push=st.builds(
        Push,
        newtons=plausible_range("newtons"),
        at_seconds=st.just((1.0, 1.05)),
        duration=st.just(10.0),
        sagittal_share=plausible("sagittal_share"),
    ),
    dimensions=st.sampled_from([{}, {"ankle_damping": 3.0}, {"contact_radius": 0.0013}, {"leg_effort": 1e4}]),
)


@settings(max_examples=30, deadline=None, derandomize=True)
@given(config=CONFIG, v=V, seed=st.integers(0, 2**32 - 1))
def test_extreme_but_legal_configurations_give_numbers(config: BalanceConfig, v: tuple[float, ...], seed: int) -> None:
    spec = EpisodeSpec(v, seed, "balance", config)
    result = simulate(spec)
    assert result.termination in TERMINATIONS
    for name, value in result.fields().items():
        for number in value if isinstance(value, tuple) else (value,):
            assert isinstance(number, str) or math.isfinite(number), name
    assert (abs(observation_from(begin_episode(spec), spec.config.scale)) <= 10.0).all()
