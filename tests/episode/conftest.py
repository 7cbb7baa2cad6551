"""An episode that several tests look at."""

import pytest

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec


@pytest.fixture(scope="session")
def paper_episode() -> EpisodeResult:
    """30 s with the paper's parameters."""
    return simulate(EpisodeSpec(PAPER_STEPPING, seed=0), record_trace=True)
