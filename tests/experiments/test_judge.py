"""Judging V1 to V4: what is kept, who is the best, and how sure that is."""

import shutil
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from laboratory import RESULT

from experiments import judge as module
from experiments import trainings
from experiments.judge import KEPT_TOGETHER, Condition, Judge
from experiments.robot.best_known import around, successive_halving
from experiments.robot.second_training import ratio
from experiments.trainings import identity
from sarah.control.parameters import BALANCE_PARAMETERS
from sarah.episode.evaluation import Evaluation
from sarah.episode.tasks import BalanceConfig

SET = (0.7, 0.4, 0.7, -0.4)


def condition(episodes: int, first_seed: int = 100, **settings: Any) -> Condition:
    return Condition("a push", BalanceConfig(**settings), first_seed, episodes)


class Simulation:
    """Episodes whose score is their seed, some of which fail."""

    def __init__(self) -> None:
        self.seeds: list[int] = []
        self.fails_from = 10_000

    def evaluate(self, task: Any, parameters: tuple[float, ...], config: Any, seeds: Iterable[int]) -> Evaluation:
        seeds = list(seeds)
        if seeds[-1] >= self.fails_from:
            raise KeyboardInterrupt
        self.seeds += seeds
        endings = {seed: "fallen" if seed % 2 else "time_limit" for seed in seeds}
        return Evaluation(tuple(replace(RESULT, score=float(seed), termination=endings[seed]) for seed in seeds))


@pytest.fixture
def simulation(monkeypatch: pytest.MonkeyPatch) -> Simulation:
    made = Simulation()
    monkeypatch.setattr(module, "evaluate", made.evaluate)
    return made


def test_no_episode_is_simulated_twice(tmp_path: Path, simulation: Simulation) -> None:
    for episodes in (3, 5, 2):
        assert list(Judge(tmp_path).scores(SET, [condition(episodes)])) == [100.0 + i for i in range(episodes)]
    assert Judge(tmp_path).outcomes(SET, condition(4))["survived"] == [1.0, 0.0, 1.0, 0.0]
    others = [(SET[::-1], condition(1)), (SET, condition(1, time_limit=9.0)), (SET, condition(1, first_seed=200))]
    for parameters, asked in others:
        Judge(tmp_path).scores(parameters, [asked])
    assert simulation.seeds == [100, 101, 102, 103, 104, 100, 100, 200]


def test_an_interrupted_judge_goes_on(tmp_path: Path, simulation: Simulation) -> None:
    simulation.fails_from = 100 + KEPT_TOGETHER
    with pytest.raises(KeyboardInterrupt):
        Judge(tmp_path).scores(SET, [condition(KEPT_TOGETHER + 2)])
    simulation.fails_from = 10_000
    Judge(tmp_path).scores(SET, [condition(KEPT_TOGETHER + 2)])
    assert simulation.seeds == list(range(100, 100 + KEPT_TOGETHER + 2))


def test_outcomes_stay_until_the_code_changes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def identity_with(folder: str, file: str) -> str:
        package = shutil.copytree(here / "episode", tmp_path / folder / "episode")
        (package / file).write_text("{}")
        monkeypatch.setattr(trainings, "SARAH", package.parent)
        return identity(condition(1), ("episode",))

    here, before = trainings.SARAH, identity(condition(1), ("episode",))
    assert identity_with("shipped", "parameter_sets.json") == before != identity_with("changed", "reward.py")


def test_halving_ends_with_the_best_and_asks_most_for_little() -> None:
    asked: list[tuple[int, int]] = []

    def scores(sets: Sequence[tuple[float, ...]], episodes: int) -> list[float]:
        asked.append((len(sets), episodes))
        noise = 0.4 / episodes
        return [-abs(one[0] - 5.0) + noise * (index % 2) for index, one in enumerate(sets)]

    ranked = successive_halving([(float(value),) for value in range(16)], [(16, 1), (4, 4), (2, 16)], scores)
    assert ranked[0] == (5.0,) and sorted(ranked) == [(float(value),) for value in range(16)]
    assert asked == [(16, 1), (4, 4), (2, 16)]


def test_candidates_lie_around_known_sets_and_within_the_box() -> None:
    near, far = (0.7, 0.0, 0.7, 0.0), (-2.0, 2.0, 2.0, -2.0)
    drawn = np.array(around([near], 200))
    assert np.allclose(drawn.mean(axis=0), near, atol=0.2)
    low, high = ([getattr(parameter, end) for parameter in BALANCE_PARAMETERS] for end in ("low", "high"))
    assert (drawn >= low).all() and (np.array(around([far], 200)) <= high).all()
    before, after = around([near, SET], 40), around([(0.8, *near[1:]), SET], 40)  # of which one set has changed
    assert 5 < sum(one == other for one, other in zip(before, after, strict=True)) < 35


def test_the_error_of_a_ratio_is_that_of_pairs() -> None:
    episodes = np.random.default_rng(0).normal(0.7, 0.2, (2000, 1, 100))
    same = ratio("share", 0.9 * episodes[0], episodes[0])
    assert same["share"] == pytest.approx(0.9) and same["share_error"] == pytest.approx(0.0)
    own = 0.9 * episodes + np.random.default_rng(1).normal(0.0, 0.1, episodes.shape)
    found = [ratio("share", mine, others) for mine, others in zip(own, episodes, strict=True)]
    spread = np.std([row["share"] for row in found])
    assert np.mean([row["share_error"] for row in found]) == pytest.approx(spread, rel=0.1)


def test_the_error_of_a_mean_ratio_knows_the_noise_of_pushes_and_of_trainings() -> None:
    """Shares of 0.9 and 1.1 differ by trainings alone; equal ones by the pushes alone."""
    best = np.full((1, 4), 0.5)
    assert ratio("share", np.array([0.9 * best[0], 1.1 * best[0]]), best)["share_error"] == pytest.approx(0.1)
    pushes = np.array([0.4, 0.6, 0.4, 0.6])
    of_one = ratio("share", pushes[np.newaxis], best)["share_error"]
    assert ratio("share", np.array([pushes, pushes]), best)["share_error"] == pytest.approx(of_one)
    assert of_one == pytest.approx(np.std(pushes / 0.5, ddof=1) / 2.0)
