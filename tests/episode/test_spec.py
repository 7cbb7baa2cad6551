"""What a specification refuses."""

import pytest

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.spec import EpisodeSpec
from sarah.errors import ConfigurationError


def test_spec_refuses_unknown_tasks_and_bad_parameters() -> None:
    with pytest.raises(ConfigurationError, match="unknown task 'steping', did you mean 'stepping'"):
        EpisodeSpec(PAPER_STEPPING, 0, task="steping")
    with pytest.raises(ConfigurationError, match="P1 must be between"):
        EpisodeSpec((3.0, 1.3, 0.1, 1.0, 1.0), 0)


@pytest.mark.parametrize("seed", [None, -1, 1.5, True])
def test_spec_refuses_seeds_that_would_not_repeat(seed: object) -> None:
    with pytest.raises(ConfigurationError, match="seed must be a whole number from 0"):
        EpisodeSpec(PAPER_STEPPING, seed)  # type: ignore[arg-type]
