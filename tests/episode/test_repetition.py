"""The same specification gives the same bytes, whatever else happens; another one gives others."""

import dataclasses
import json
import subprocess
import sys

import pytest

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode, simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.simulation.physics import Physics

SHORT = EpisodeConfig(time_limit=6.0)


def test_what_a_process_simulated_before_or_meanwhile_changes_nothing() -> None:
    spec = EpisodeSpec(PAPER_STEPPING, seed=4, config=SHORT)
    expected = simulate(spec)
    longer = BalanceConfig(physics=Physics(1000, 10), dimensions={"thigh_length": 0.4}, time_limit=6.0)
    simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), seed=5, task="balance", config=longer))
    with Episode.of(spec) as episode:
        episode.stand()
        assert simulate(spec) == expected
        assert episode.run(PAPER_STEPPING) == expected


@pytest.mark.parametrize(
    ("task", "config", "parameters"),
    [
        ("stepping", "EpisodeConfig", (0.4, 1.3, 0.1, 1.0, 1.0)),
        ("balance", "BalanceConfig", (1.0, 0.1, 0.5, -0.2)),
    ],
)
def test_same_spec_gives_identical_results_in_two_fresh_processes(
    task: str, config: str, parameters: tuple[float, ...]
) -> None:
    program = (
        "import dataclasses, json, sarah; "
        f"config = sarah.{config}(time_limit=6.0); "
        f"result = sarah.simulate(sarah.EpisodeSpec({parameters}, 7, {task!r}, config)); "
        "print(json.dumps(dataclasses.asdict(result)))"
    )
    runs = [subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout for _ in range(2)]
    assert runs[0] == runs[1]
    assert json.loads(runs[0])["steps"] > 0


def test_seeds_differ_and_the_order_of_episodes_does_not_matter() -> None:
    specs = [EpisodeSpec(PAPER_STEPPING, seed, config=SHORT) for seed in (3, 4)]
    forward = [simulate(spec) for spec in specs]
    backward = [simulate(spec) for spec in reversed(specs)]
    assert forward == backward[::-1]
    assert forward[0] != forward[1]


def test_printed_reward_form_changes_the_return() -> None:
    printed = dataclasses.replace(SHORT, reward_form="printed")
    returns = [simulate(EpisodeSpec(PAPER_STEPPING, 0, config=config)).episode_return for config in (SHORT, printed)]
    assert returns[0] != returns[1]


def test_longer_feet_are_another_robot() -> None:
    longer = dataclasses.replace(SHORT, dimensions={"forefoot_contact": 0.15, "hindfoot_contact": 0.15})
    assert simulate(EpisodeSpec(PAPER_STEPPING, 0, config=SHORT)) != simulate(
        EpisodeSpec(PAPER_STEPPING, 0, config=longer)
    )
