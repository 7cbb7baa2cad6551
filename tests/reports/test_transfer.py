"""The transfer between engines: how much of a score is kept."""

import dataclasses
from typing import Any

import pytest
from laboratory import RESULT

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.evaluation import Evaluation
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import STEPPING
from sarah.reports.transfer import Transfer, as_markdown
from sarah.simulation.engines import Engine


def scoring(score: float) -> Evaluation:
    return Evaluation((dataclasses.replace(RESULT, score=score),))


LEARNED = EpisodeSpec(PAPER_STEPPING, 0, STEPPING, EpisodeConfig(engine="mujoco"))
SCORES: dict[Engine, Evaluation] = {"pybullet": scoring(0.6), "mujoco": scoring(0.8)}


def test_the_name_of_a_run_stays_in_its_cell_of_the_table() -> None:
    rows = [as_markdown([Transfer(name, LEARNED, SCORES)]) for name in ("run_1", "a|b", "[x](y) `<b>`")]
    assert "| run_1 |" in rows[0] and r"| a\|b |" in rows[1] and r"| \[x\](y) \`\<b\>\` |" in rows[2]


def test_kept_is_the_lowest_share_in_any_other_engine() -> None:
    scores: dict[Any, Evaluation] = {"pybullet": scoring(0.6), "mujoco": scoring(0.8), "third": scoring(0.4)}
    assert Transfer("run", LEARNED, scores).kept == pytest.approx(0.5)
    assert Transfer("run", LEARNED, {**scores, "mujoco": scoring(0.0)}).kept == 0.0
