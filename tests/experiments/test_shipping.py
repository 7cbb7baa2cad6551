"""The rule by which the package's V1 to V4 are chosen."""

from collections.abc import Mapping

import numpy as np
import pytest

from experiments.judge import Condition, Judge
from experiments.robot.balance_trainings import SHIPPED
from experiments.robot.shipping import DIRECTIONS, FULL, HARD, LEVEL, NEW, ROUNDS, WEAK, Candidate, Round, rounded
from sarah.simulation.engines import Engine

ENGINES: tuple[Engine, ...] = ("mujoco", "pybullet")
SAME = {HARD: 1.0, NEW: 1.0, LEVEL: 1.0, WEAK: 1.0}
"""Scores relative to those of the shipped set."""
KEPT = {"slope of 4°": 0.98, "slope of 6°": 0.95}
PUSHES = np.linspace(0.4, 0.9, 100)
"""Scores of the shipped set under pushes, and without one 0.9."""


def candidate(
    run: str, relative: Mapping[str, float], kept: Mapping[str, float] = KEPT, last_round: int = len(ROUNDS)
) -> Candidate:
    """A candidate that differs from the shipped set."""
    scores, shipped = {}, {}
    for engine in ENGINES:
        for name, share in relative.items():
            shipped[engine, name] = np.full(8, 0.9) if name == LEVEL else PUSHES
            scores[engine, name] = share * shipped[engine, name]
        for name, share in kept.items():
            scores[engine, name] = np.full(8, 0.9 * relative[LEVEL] * share)
            shipped[engine, name] = np.full(8, 0.9 * KEPT[name])
    parameters = SHIPPED if run == "shipped before" else (1.0, 0.0, 1.0, 0.0)
    return Candidate(run, parameters, last_round, scores, shipped)


TODAY = candidate("shipped before", SAME)


def choice(*candidates: Candidate) -> str:
    return FULL.choice([TODAY, *candidates]).run


def test_of_those_that_pass_the_best_over_all_is_shipped() -> None:
    better = candidate("better", SAME | {HARD: 1.03})
    best = candidate("best", SAME | {HARD: 1.01, WEAK: 1.1})
    assert choice(better, best) == "best"
    assert best.overall == pytest.approx((1.01 * 1.1) ** (1 / 5))


@pytest.mark.parametrize("kept", [KEPT | {"slope of 4°": 0.94}, KEPT | {"slope of 6°": 0.89}])
def test_a_set_that_loses_on_a_slope_is_not_shipped(kept: dict[str, float]) -> None:
    other = candidate("other", SAME | {HARD: 1.3}, kept)
    assert choice(other) == "shipped before"
    assert FULL.verdict(other).startswith("loses on a slope of")


def test_a_set_that_is_worse_under_new_pushes_is_not_shipped() -> None:
    worse = candidate("worse", SAME | {HARD: 1.1, NEW: 0.98, WEAK: 1.5})
    assert choice(worse) == "shipped before"
    assert FULL.verdict(worse) == "worse under new hard pushes"


def test_pushes_that_test_have_not_chosen() -> None:
    def seeds(size: Round, name: str) -> set[int]:
        asked = [one for engine in ENGINES for one in FULL.conditions(engine, size.episodes).get(name, [])]
        return {seed for one in asked for seed in range(one.first_seed, one.first_seed + one.episodes)}

    new = seeds(ROUNDS[-1], NEW)
    assert new and all(new.isdisjoint(seeds(size, HARD)) for size in ROUNDS)
    assert candidate("lucky", SAME | {NEW: 1.5}).overall == TODAY.overall


def test_a_difference_within_the_noise_of_the_pushes_is_no_loss() -> None:
    noise = np.tile([-0.21, 0.2], len(PUSHES) // 2)
    scores = {key: PUSHES + noise if key[1] == NEW else own * 1.1 for key, own in TODAY.scores.items()}
    other = Candidate("other", (1.0, 0.0, 1.0, 0.0), len(ROUNDS), scores, TODAY.shipped)
    assert other.relative["mujoco", NEW] < 1.0 and choice(other) == "other"


def test_only_who_met_all_conditions_is_shipped() -> None:
    assert choice(candidate("early", {**SAME, HARD: 1.2}, last_round=2)) == "shipped before"


def test_if_none_passes_the_shipped_set_stays() -> None:
    slope = {"slope of 4°": 0.90, "slope of 6°": 0.80}
    today = candidate("shipped before", SAME, slope)
    assert FULL.choice([candidate("other", SAME, slope), today]).run == "shipped before"


def test_on_a_slope_the_worst_direction_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    def scores(self: Judge, parameters: tuple[float, ...], asked: list[Condition]) -> np.ndarray:
        directions.update(one.config.terrain.direction_degrees[0] for one in asked)
        return np.array([0.5 if one.config.terrain.direction_degrees[0] == 90.0 else 0.9 for one in asked])

    directions: set[float] = set()
    monkeypatch.setattr(Judge, "scores", scores)
    found = FULL.scores(SHIPPED, "mujoco", ROUNDS[1].episodes)
    assert directions == set(DIRECTIONS) and list(found["mujoco", "slope of 6°"]) == [0.5]


def test_shipped_values_have_two_digits_and_no_negative_zero() -> None:
    assert repr(rounded((0.714, -0.001, 1.999, -0.398))) == "(0.71, 0.0, 2.0, -0.4)"
