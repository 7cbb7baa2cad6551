"""The parameters that the package ships: how sets are judged and chosen, and that they step and survive pushes."""

import dataclasses
import json
import shutil
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from laboratory import RESULT
from pandas import DataFrame

from experiments import judge as module
from experiments import record, trainings
from experiments.judge import KEPT_TOGETHER, Condition, Judge
from experiments.robot import shipping
from experiments.robot.balance_trainings import SHIPPED
from experiments.robot.best_known import BEST, around, successive_halving
from experiments.robot.second_training import COMPARED, MU, RECOMMENDED, closeness, ratio
from experiments.robot.shipped_parameters import CONDITIONS, ship
from experiments.robot.shipping import FULL, HARD, LEVEL, NEW, ROUNDS, WEAK, Candidate, Round, rounded
from experiments.trainings import identity
from sarah.control.parameters import BALANCE_PARAMETERS
from sarah.episode.episode import simulate
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push, PushedConfig
from sarah.episode.shipped import FILE, shipped
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.simulation.engines import Engine

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


def test_the_error_of_a_ratio_knows_both_kinds_of_noise() -> None:
    """Shares of 0.9 and 1.1 differ by trainings alone; equal ones by the pushes alone."""
    best = np.full((1, 4), 0.5)
    assert ratio("share", np.array([0.9 * best[0], 1.1 * best[0]]), best)["share_error"] == pytest.approx(0.1)
    pushes = np.array([0.4, 0.6, 0.4, 0.6])
    of_one = ratio("share", pushes[np.newaxis], best)["share_error"]
    assert ratio("share", np.array([pushes, pushes]), best)["share_error"] == pytest.approx(of_one)
    assert of_one == pytest.approx(np.std(pushes / 0.5, ddof=1) / 2.0)


def judged(*sets: tuple[str, str, np.ndarray]) -> DataFrame:
    """Rows of sets in MuJoCo: what each is, its run, and its scores."""
    kinds, runs, values = zip(*sets, strict=True)
    scores = [" ".join(map(str, of_one)) for of_one in values]
    return DataFrame({"kind": kinds, "run": runs, "engine": "mujoco", "survival_100": 1.0, "scores": scores})


def test_luck_that_trainings_share_with_the_best_known_makes_no_count_uncertain() -> None:
    """All lose the same 4 % of a best score that scatters widely."""
    luck = np.random.default_rng(0).normal(0.7, 0.3, 40)
    learned = [(kind, "naf seed 1", 0.96 * luck) for kind in (RECOMMENDED, MU)]
    assert closeness(judged((COMPARED, BEST, luck), *learned)).count(" | 1 | 1 | 1 | ") == 2


def test_what_networks_say_may_still_have_to_be_judged() -> None:
    best, learned = np.full(4, 0.8), np.full(4, 0.72)
    found = closeness(judged((COMPARED, BEST, best), (RECOMMENDED, "naf seed 1", learned)))
    assert f"| mujoco | {RECOMMENDED} | 1 | 90.0" in found and f"| {MU} |" not in found


ENGINES: tuple[Engine, ...] = ("mujoco", "pybullet")
SAME = {HARD: 1.0, NEW: 1.0, LEVEL: 1.0, WEAK: 1.0}
"""Scores relative to those of the shipped set."""
KEPT = {"slope of 4°": 0.98, "slope of 6°": 0.95}
PUSHES = np.linspace(0.4, 0.9, 100)
"""Scores of the shipped set under pushes, and without one 0.9."""


def candidate(
    run: str, relative: Mapping[str, float], kept: Mapping[str, float] = KEPT, last_round: int = len(ROUNDS)
) -> Candidate:
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


def test_a_set_that_is_worse_somewhere_is_not_shipped() -> None:
    slopes = ({"slope of 4°": 0.94}, {"slope of 6°": 0.89})
    lost = [candidate("other", SAME | {HARD: 1.3}, KEPT | kept) for kept in slopes]
    worse = candidate("worse", SAME | {HARD: 1.1, NEW: 0.98, WEAK: 1.5})
    early = candidate("early", {**SAME, HARD: 1.2}, last_round=2)  # it has not met all conditions
    assert all(FULL.verdict(other).startswith("loses on a slope of") for other in lost)
    assert FULL.verdict(worse) == "worse under new hard pushes"
    assert {choice(other) for other in (*lost, worse, early)} == {"shipped before"}
    steep = {"slope of 4°": 0.90, "slope of 6°": 0.80}  # on which none passes
    assert FULL.choice([candidate(name, SAME, steep) for name in ("other", "shipped before")]).run == "shipped before"


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


def test_on_a_slope_the_worst_direction_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    def scores(self: Judge, parameters: tuple[float, ...], asked: list[Condition]) -> np.ndarray:
        directions.update(one.config.terrain.direction_degrees[0] for one in asked)
        return np.array([0.5 if one.config.terrain.direction_degrees[0] == 90.0 else 0.9 for one in asked])

    directions: set[float] = set()
    monkeypatch.setattr(Judge, "scores", scores)
    found = FULL.scores(SHIPPED, "mujoco", ROUNDS[1].episodes)
    assert directions == set(shipping.DIRECTIONS) and list(found["mujoco", "slope of 6°"]) == [0.5]


SEEDS = range(1000, 1004)


def test_the_packages_file_says_what_the_result_says(tmp_path: Path) -> None:
    result = record.read("shipped_parameters")
    ship(result, tmp_path / FILE.name)
    assert (tmp_path / FILE.name).read_text(encoding="utf-8") == FILE.read_text(encoding="utf-8")
    # A set keeps its origin as long as it ships.
    rows = [{**row, "V1": "1.23"} if row["set"] == "balance" else row for row in result.rows]
    ship(dataclasses.replace(result, rows=rows, commit="another"), tmp_path / FILE.name)
    written = json.loads((tmp_path / FILE.name).read_text(encoding="utf-8"))
    assert written["stepping"]["origin"] == shipped()["stepping"]["origin"]
    assert written["balance"]["origin"]["commit"] == "another" and written["balance"]["parameters"]["V1"] == 1.23


@pytest.mark.parametrize("name", shipped())
def test_every_figure_is_there_and_every_value_has_two_digits(name: str) -> None:
    assert repr(rounded((0.714, -0.001, 1.999, -0.398))) == "(0.71, 0.0, 2.0, -0.4)"
    content = shipped()[name]
    assert all(set(of_engine) == set(CONDITIONS) for of_engine in content["figures"].values())
    values = [*content["parameters"].values(), *content["settings"].get("stepping", ())]
    assert values == [round(value, shipping.DIGITS) for value in values]
    assert BALANCE.episode.stepping == TRAINED_STEPPING == PARAMETER_SETS["stepping"].spec.parameters


@pytest.mark.parametrize("name", PARAMETER_SETS)
def test_every_set_steps_by_its_sensors(name: str) -> None:
    spec = PARAMETER_SETS[name].spec
    calm = dataclasses.replace(spec.config, time_limit=8.0)
    if isinstance(calm, BalanceConfig):
        calm = dataclasses.replace(calm, push=Push(newtons=(0.0, 0.0)))
    found = evaluate(spec.task, spec.parameters, calm, SEEDS[:2])
    assert found.is_gait and found.survival_rate == 1.0


@pytest.mark.parametrize(("name", "newtons"), [("paper", 50.0), ("stepping", 50.0), ("balance", 100.0)])
def test_every_set_survives_most_pushes_of_its_kind(name: str, newtons: float) -> None:
    spec = PARAMETER_SETS[name].spec
    push = Push(newtons=(newtons, newtons), at_seconds=(2.0, 3.0))
    shared = {**vars(spec.config), "time_limit": 8.0, "push": push}
    config = BalanceConfig(**shared) if name == "balance" else PushedConfig(**shared)
    assert evaluate(spec.task, spec.parameters, config, SEEDS).survival_rate > 0.5


def test_what_commands_show_first_comes_back_from_its_push() -> None:
    spec = PARAMETER_SETS["balance"].spec
    result = simulate(dataclasses.replace(spec, config=dataclasses.replace(spec.config, time_limit=12.0)))
    assert BALANCE.config_of(spec.config).push.newtons[0] > 0.0 and result.survived
