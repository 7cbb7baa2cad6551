"""What the README says of the paper's parameters and of clocks, over many seeds: minutes of simulation."""

import dataclasses
import random

import pytest

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.evaluation import SMALLEST_SENSOR_SHARE, evaluate
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.workers import Workers
from sarah.simulation.physics import PHYSICS

pytestmark = pytest.mark.slow


def test_papers_parameters_step_on_20_seeds(workers: Workers) -> None:
    evaluation = evaluate("stepping", PAPER_STEPPING, EpisodeConfig(), range(20), workers)
    assert evaluation.survivors >= 19
    assert all(2.3 <= result.steps_per_second <= 3.5 for result in evaluation.results if result.survived)
    assert evaluation.statistic("drift", "max") < 0.08
    assert evaluation.median("score") >= 0.78


def test_no_clock_among_random_parameters_pays(workers: Workers) -> None:
    generator = random.Random(0)
    drawn = [tuple(generator.uniform(0.0, 2.0) for _ in range(5)) for _ in range(60)]
    results = workers.simulate_all([EpisodeSpec(parameters, seed) for seed, parameters in enumerate(drawn)])
    shares = [(min(result.shifts_by_sensors, result.lifts_by_sensors), result.score) for result in results]
    clocks = [score for share, score in shares if share < SMALLEST_SENSOR_SHARE]
    assert len(clocks) > 10 and max(clocks) < 0.6


def test_v1_saves_the_robot_from_pushes_to_the_side(workers: Workers) -> None:
    """Forty pushes of 100 N from the sides: at V = 0 about 6 in 10 survive, with V1 = 1 nearly all.

    At the reference physics; at the standard one a few more fall.
    """
    push = Push(newtons=(100.0, 100.0), at_seconds=(2.0, 4.0))
    survived = {}
    for v1 in (0.0, 1.0):
        specs = []
        for seed in range(40):
            side = (0.0, 0.0) if seed % 2 else (180.0, 180.0)
            pushed = dataclasses.replace(push, degrees=side)
            config = BalanceConfig(physics=PHYSICS["reference"], push=pushed, time_limit=8.0)
            specs.append(EpisodeSpec((v1, 0.0, 0.0, 0.0), seed, "balance", config))
        survived[v1] = sum(result.survived for result in workers.simulate_all(specs))
    assert survived[1.0] >= 38 and survived[1.0] >= survived[0.0] + 8
