"""The same specification gives the same bytes, whatever else happens; another one gives others."""

import dataclasses
import json
import subprocess
import sys

import pytest
from laboratory import COARSE_PHYSICS

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode, simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.simulation.physics import Physics

SHORT = EpisodeConfig(time_limit=3.0)
SPEC = EpisodeSpec(PAPER_STEPPING, 4, config=SHORT)


def test_what_was_simulated_before_or_meanwhile_changes_nothing() -> None:
    expected = simulate(SPEC)
    longer = BalanceConfig(physics=Physics(1000, 10), dimensions={"thigh_length": 0.4}, time_limit=2.0)
    simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), seed=5, task="balance", config=longer))
    with Episode.of(SPEC, record_trace=True) as episode:
        episode.stand()
        assert simulate(SPEC) == expected
        assert episode.run(PAPER_STEPPING) == expected


def test_a_fresh_process_gives_the_same_result() -> None:
    program = (
        "import dataclasses, json, sarah; "
        "config = sarah.BalanceConfig(time_limit=3.0); "
        "result = sarah.simulate(sarah.EpisodeSpec((1.0, 0.1, 0.5, -0.2), 7, 'balance', config)); "
        "print(json.dumps(dataclasses.asdict(result)))"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, check=True, text=True)
    here = simulate(EpisodeSpec((1.0, 0.1, 0.5, -0.2), 7, "balance", BalanceConfig(time_limit=3.0)))
    assert run.stdout == json.dumps(dataclasses.asdict(here)) + "\n" and here.steps > 0


@pytest.mark.parametrize(
    "changes",
    [
        {"seed": 3},
        {"config": {"reward_form": "printed"}},
        {"config": {"dimensions": {"forefoot_contact": 0.15, "hindfoot_contact": 0.15}}},
    ],
)
def test_another_specification_gives_another_result(changes: dict) -> None:
    coarse = dataclasses.replace(SHORT, physics=COARSE_PHYSICS)
    spec = EpisodeSpec(PAPER_STEPPING, 4, config=coarse)
    other = EpisodeSpec(
        PAPER_STEPPING, changes.get("seed", 4), config=dataclasses.replace(coarse, **changes.get("config", {}))
    )
    assert simulate(other) != simulate(spec)
