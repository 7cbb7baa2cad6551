"""The rule by which the package's V1 to V4 are chosen."""

from collections.abc import Mapping

import numpy as np
import pytest

from experiments.balance_trainings import SHIPPED
from experiments.shipping_rule import ROUNDS, Candidate, Criterion, Round, Shipping, rounded, slope_name
from sarah.simulation.engines import Engine

ENGINES: tuple[Engine, ...] = ("mujoco", "pybullet")
SAME = {"hard pushes": 1.0, "new hard pushes": 1.0, "level ground": 1.0, "weak servos": 1.0}
"""Scores relative to those of the shipped set."""
KEPT = {4.0: 0.98, 6.0: 0.95}
PUSHES = np.linspace(0.4, 0.9, 100)
"""Scores of the shipped set under pushes, and without one 0.9."""


def candidate(
    run: str, relative: Mapping[str, float], kept: Mapping[float, float] = KEPT, last_round: int = len(ROUNDS)
) -> Candidate:
    """A candidate that differs from the shipped set."""
    criteria, scores, shipped = [], [], []
    for engine in ENGINES:
        for name, share in relative.items():
            others = np.full(8, 0.9) if name == "level ground" else PUSHES
            criteria.append(Criterion(name, engine, []))
            scores.append(share * others)
            shipped.append(others)
        for degrees, share in kept.items():
            criteria.append(Criterion(slope_name(degrees), engine, [], is_worst=True))
            scores.append(np.full(8, 0.9 * relative["level ground"] * share))
            shipped.append(np.full(8, 0.9 * KEPT[degrees]))
    parameters = SHIPPED if run == "shipped before" else (1.0, 0.0, 1.0, 0.0)
    return Candidate(run, parameters, last_round, tuple(criteria), tuple(scores), tuple(shipped))


TODAY = candidate("shipped before", SAME)


def choice(*candidates: Candidate) -> str:
    return Shipping().choice([TODAY, *candidates]).run


def test_of_those_that_pass_the_best_over_all_is_shipped() -> None:
    better = candidate("better", SAME | {"hard pushes": 1.03})
    best = candidate("best", SAME | {"hard pushes": 1.01, "weak servos": 1.1})
    assert choice(better, best) == "best"
    assert best.merit[1] == pytest.approx((1.01 * 1.1) ** (1 / 5))


@pytest.mark.parametrize("kept", [{4.0: 0.94, 6.0: 0.95}, {4.0: 0.98, 6.0: 0.89}])
def test_a_set_that_loses_on_a_slope_is_not_shipped(kept: dict[float, float]) -> None:
    other = candidate("other", SAME | {"hard pushes": 1.3}, kept)
    assert choice(other) == "shipped before"
    assert Shipping().verdict(other).startswith("loses on a slope of")


def test_a_set_that_is_worse_under_new_pushes_is_not_shipped() -> None:
    worse = candidate("worse", SAME | {"hard pushes": 1.1, "new hard pushes": 0.98, "weak servos": 1.5})
    assert choice(worse) == "shipped before"
    assert Shipping().verdict(worse) == "worse under new hard pushes"


def test_pushes_that_test_have_not_chosen() -> None:
    def seeds(size: Round, name: str) -> set[int]:
        asked = [one for criterion in Shipping().criteria(size) if criterion.name == name for one in criterion.asked]
        return {seed for one, count in asked for seed in range(one.first_seed, one.first_seed + count)}

    new = seeds(ROUNDS[-1], "new hard pushes")
    assert new and all(new.isdisjoint(seeds(size, "hard pushes")) for size in ROUNDS)
    assert candidate("lucky", SAME | {"new hard pushes": 1.5}).merit == TODAY.merit


def test_a_difference_within_the_noise_of_the_pushes_is_no_loss() -> None:
    noise = np.tile([-0.21, 0.2], len(PUSHES) // 2)
    scores = tuple(
        PUSHES + noise if criterion.name == "new hard pushes" else own * 1.1
        for criterion, own in zip(TODAY.criteria, TODAY.scores, strict=True)
    )
    other = Candidate("other", (1.0, 0.0, 1.0, 0.0), len(ROUNDS), TODAY.criteria, scores, TODAY.shipped)
    assert other.relative[1] < 1.0 and choice(other) == "other"


def test_only_who_met_all_conditions_is_shipped() -> None:
    assert choice(candidate("early", {**SAME, "hard pushes": 1.2}, last_round=2)) == "shipped before"


def test_if_none_passes_the_shipped_set_stays() -> None:
    slope = {4.0: 0.90, 6.0: 0.80}
    today = candidate("shipped before", SAME, slope)
    assert Shipping().choice([candidate("other", SAME, slope), today]).run == "shipped before"


def test_on_a_slope_the_worst_direction_counts() -> None:
    (slope,) = (
        criterion
        for criterion in Shipping(engines=("mujoco",)).criteria(ROUNDS[1])
        if criterion.name == slope_name(6.0)
    )
    uphill = [condition.config.terrain.direction_degrees[0] for condition, _ in slope.asked]
    assert uphill == [45.0 * index for index in range(8)]

    class Told:
        def scores(self, parameters: tuple[float, ...], asked: list) -> np.ndarray:
            return np.concatenate(
                [[0.5 if one.config.terrain.direction_degrees[0] == 90.0 else 0.9] for one, _ in asked]
            )

    assert list(slope.scores(SHIPPED, Told())) == [0.5]


def test_shipped_values_have_two_digits_and_no_negative_zero() -> None:
    assert repr(rounded((0.714, -0.001, 1.999, -0.398))) == "(0.71, 0.0, 2.0, -0.4)"
