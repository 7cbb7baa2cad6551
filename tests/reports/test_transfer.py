"""The transfer between engines: how much of a score is kept."""

import dataclasses

import pytest
from laboratory import RESULT

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.evaluation import Evaluation
from sarah.episode.settings import EpisodeConfig
from sarah.reports.transfer import LearnedParameters, Transfer


def scoring(score: float) -> Evaluation:
    return Evaluation((dataclasses.replace(RESULT, score=score),))


def test_kept_is_the_lowest_share_in_any_other_engine() -> None:
    learned = LearnedParameters("run", "stepping", PAPER_STEPPING, EpisodeConfig(engine="mujoco"))
    scores = {"pybullet": scoring(0.6), "mujoco": scoring(0.8), "third": scoring(0.4)}
    assert Transfer(learned, scores).kept == pytest.approx(0.5)  # type: ignore[arg-type]  # a third engine
    assert Transfer(learned, {**scores, "mujoco": scoring(0.0)}).kept == 0.0  # type: ignore[arg-type]
