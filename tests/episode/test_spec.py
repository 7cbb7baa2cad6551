"""A specification refuses what cannot be; the same one gives the same bytes, whatever else happens."""

import json
import math
import subprocess
import sys
from collections.abc import Callable
from dataclasses import asdict, replace
from functools import partial
from typing import Any, cast

import numpy as np
import pytest
from laboratory import COARSE_PHYSICS, NEEDS_PYBULLET, RESULT

from sarah import BALANCE, PHYSICS, STEPPING, BalanceConfig, EpisodeConfig, EpisodeSpec, Physics, Randomisation, Terrain
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.accuracy import physics_warning
from sarah.episode.episode import Episode, simulate
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError
from sarah.robot.dimensions import default_dimensions
from sarah.simulation.engines import Engine

EVALUATED: Any = partial(evaluate, "stepping", PAPER_STEPPING, EpisodeConfig())
SPECIFIED, BALANCED, WORKERS = (cast(Any, kind) for kind in (EpisodeSpec, BalanceConfig, Workers))
MISTAKES: list[tuple[str, Callable[[], object]]] = [
    ("unknown task 'steping', did you mean 'stepping'", lambda: SPECIFIED(PAPER_STEPPING, 0, task="steping")),
    *(
        ("parameter P4 must be between 0 and 2, not", partial(SPECIFIED, (1.0, 1.0, 1.0, value, 1.0), 0))
        for value in (math.nan, math.inf, 2.1, -0.1, "1", True)
    ),
    *(("seed must be a whole number from 0", partial(SPECIFIED, PAPER_STEPPING, seed)) for seed in (-1, 1.5, True)),
    ("dimensions must be a Mapping, not 3", lambda: BALANCED(dimensions=3)),
    (r"stepping must be 5 numbers \(P1 to P5\), not 3", lambda: BALANCED(stepping=3)),
    ("seeds must not be empty: an evaluation needs an episode", lambda: EVALUATED([])),
    (r"seeds must be several whole numbers, such as range\(10\), not 3", lambda: EVALUATED(3)),
    (r"workers must be an executor, as in .*, not 4", lambda: EVALUATED([1], 4)),
    (r"unknown metric 'scor', did you mean 'score'\?", lambda: Evaluation((RESULT,)).mean("scor")),
    (r"unknown statistic 'medain', did you mean", lambda: Evaluation((RESULT,)).statistic("score", "medain")),
    ("workers must be between 0 and 256, not -1", lambda: WORKERS(-1)),
    (r"workers must be a whole number, not 1\.5$", lambda: WORKERS(1.5)),
    ("workers start on this machine, .*: give one of the two", lambda: WORKERS(2, "tcp://127.0.0.1:1")),
    *(
        ("workers start in a with statement", partial(workers.submit, simulate, 5))
        for workers in (Workers(2), Workers(scheduler="tcp://127.0.0.1:1"))
    ),
]


@pytest.mark.parametrize(("words", "mistake"), MISTAKES)
def test_what_cannot_be_is_refused(words: str, mistake: Callable[[], object]) -> None:
    with pytest.raises(ConfigurationError, match=f"^{words}"):
        mistake()


def test_a_spec_does_not_follow_what_it_was_made_of() -> None:
    dimensions = {"hinge_height": 0.04}
    spec = EpisodeSpec(PAPER_STEPPING, np.int64(3), config=EpisodeConfig(dimensions=dimensions))  # type: ignore[arg-type]
    dimensions["hinge_height"] = 0.05
    assert spec.config.dimensions == {"hinge_height": 0.04} and type(spec.seed) is int


SHORT = EpisodeConfig(time_limit=3.0)
SPEC = EpisodeSpec(PAPER_STEPPING, 4, config=SHORT)


def test_what_was_simulated_before_or_meanwhile_changes_nothing(engine: Engine) -> None:
    spec = replace(SPEC, config=EpisodeConfig(engine=engine, time_limit=3.0))
    expected = simulate(spec)
    longer = BalanceConfig(engine=engine, physics=Physics(1000, 10), dimensions={"thigh_length": 0.4}, time_limit=2.0)
    simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), seed=5, task="balance", config=longer))
    with Episode.of(spec, record_trace=True) as episode:
        episode.stand()
        assert simulate(spec) == expected
        assert episode.run(PAPER_STEPPING) == expected


def test_a_fresh_process_gives_the_same_result(engine: Engine) -> None:
    program = (
        "import dataclasses, json, sarah\n"
        f"config = sarah.BalanceConfig(engine='{engine}', time_limit=3.0)\n"
        "for seed in (8, 7):\n"
        "    result = sarah.simulate(sarah.EpisodeSpec((1.0, 0.1, 0.5, -0.2), seed, 'balance', config))\n"
        "print(json.dumps(dataclasses.asdict(result)))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True, text=True)
    config = BalanceConfig(engine=engine, time_limit=3.0)
    here = simulate(EpisodeSpec((1.0, 0.1, 0.5, -0.2), 7, "balance", config))
    assert run.stdout == json.dumps(asdict(here)) + "\n" and here.steps > 0


SQUARE_FEET = {"dimensions": {"forefoot_contact": 0.15, "hindfoot_contact": 0.15}}


@pytest.mark.parametrize(("seed", "changes"), [(3, {}), (4, {"reward_form": "printed"}), (4, SQUARE_FEET)])
def test_another_specification_gives_another_result(seed: int, changes: dict[str, Any]) -> None:
    coarse = replace(SHORT, physics=COARSE_PHYSICS)
    other = EpisodeSpec(PAPER_STEPPING, seed, config=replace(coarse, **changes))
    assert simulate(other) != simulate(EpisodeSpec(PAPER_STEPPING, 4, config=coarse))


LOW, PAPER = (0.02, 0.5, 0.6, 1.0, 1.0), (0.4, 1.3, 0.1, 1.0, 1.0)
LATE = EpisodeConfig(engine="pybullet", randomisation=Randomisation(delay_seconds=0.02))
PUNCTUAL = BalanceConfig(engine="pybullet", stepping=LOW, randomisation=Randomisation(delay_seconds=0.01))
BUMPS = EpisodeConfig(engine="pybullet", terrain=Terrain(roughness=(0.01, 0.01)))
LIGHT_FEET = {name: 0.1 * default_dimensions()[name] for name in ("forefoot_mass", "hindfoot_mass")}


@NEEDS_PYBULLET
@pytest.mark.parametrize(
    ("parameters", "config", "warns"),
    [
        (LOW, LATE, True),
        (PAPER, LATE, False),
        (LOW, EpisodeConfig(engine="pybullet"), False),  # 10 ms
        (LOW, replace(LATE, physics=PHYSICS["reference"]), False),
        (LOW, replace(LATE, randomisation=Randomisation(False, delay_seconds=0.02)), False),
        (LOW, replace(LATE, engine="mujoco"), False),
        ((1.0, 0.0, 1.0, 0.0), PUNCTUAL, True),  # hips that move are doubted with any delay
        ((0.0, 0.0, 0.0, 0.0), PUNCTUAL, False),
        (PAPER, replace(BUMPS, physics=replace(PHYSICS["standard"], rate=100)), True),
        (PAPER, replace(BUMPS, physics=replace(PHYSICS["standard"], rate=200)), False),
        (PAPER, EpisodeConfig(engine="pybullet", physics=replace(PHYSICS["standard"], rate=100)), False),
        (PAPER, EpisodeConfig(engine="pybullet", dimensions=LIGHT_FEET), True),
        (PAPER, EpisodeConfig(engine="mujoco", dimensions=LIGHT_FEET), False),
    ],
)
def test_where_physics_misleads_is_said(parameters: tuple[float, ...], config: EpisodeConfig, warns: bool) -> None:
    task = BALANCE if isinstance(config, BalanceConfig) else STEPPING
    assert (physics_warning(task, parameters, config) is not None) == warns
