"""Any legal settings, parameters and seed give an episode that ends, and numbers."""

import math
from typing import Any

from hypothesis import given, settings
from hypothesis import strategies as st

from sarah.control.constants import ControllerConstants
from sarah.envs.sarah_env import observation_from
from sarah.episode.ending import TERMINATIONS
from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import begin_episode
from sarah.ranges import ranges_of, types_of
from sarah.simulation.physics import Physics
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain

P = st.tuples(*[st.floats(0.0, 2.0)] * 5)
V = st.tuples(*[st.floats(-2.0, 2.0)] * 4)


def legal(kind: type, **others: st.SearchStrategy[Any]) -> st.SearchStrategy[Any]:
    """Settings with anything from end to end of what is allowed, the ends above all."""
    drawn: dict[str, st.SearchStrategy[Any]] = {}
    for name, within in ranges_of(kind).items():
        number = st.sampled_from([within.low, within.high]) | st.floats(within.low, within.high)
        ends = st.tuples(number, number).map(lambda ends: tuple(sorted(ends)))
        drawn[name] = number if types_of(kind)[name] is float else ends
    return st.builds(kind, **{**drawn, **others})


CONFIG = st.builds(
    BalanceConfig,
    physics=st.sampled_from([Physics(50, 1, 50), Physics(100, 1), Physics(300, 200), Physics(1000, 1, 1000)]),
    randomisation=legal(Randomisation),
    terrain=legal(Terrain, cell=st.sampled_from([(0.02, 0.02), (0.02, 0.1), (0.1, 0.1)]), reach=st.just(0.7)),
    controller=legal(ControllerConstants),
    time_limit=st.sampled_from([1.1, 1.5]),
    reward_form=st.sampled_from(["symmetric", "printed"]),
    stepping=P,
    push=legal(Push, at_seconds=st.just((1.0, 1.05)), duration=st.just(10.0)),
    dimensions=st.sampled_from([{}, {"ankle_damping": 3.0}, {"contact_radius": 0.0013}, {"leg_effort": 1e4}]),
)


@settings(max_examples=12, derandomize=True)
@given(config=CONFIG, v=V, seed=st.integers(0, 2**32 - 1))
def test_extreme_but_legal_configurations_give_numbers(config: BalanceConfig, v: tuple[float, ...], seed: int) -> None:
    spec = EpisodeSpec(v, seed, "balance", config)
    result = simulate(spec)
    assert result.termination in TERMINATIONS
    for name, value in result.fields().items():
        for number in value if isinstance(value, tuple) else (value,):
            assert isinstance(number, str) or math.isfinite(number), name
    assert (abs(observation_from(begin_episode(spec), spec.config.scale)) <= 10.0).all()
