"""What a specification refuses."""

import math

import numpy as np
import pytest

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import STEPPING, BalanceConfig
from sarah.errors import ConfigurationError


def test_spec_refuses_unknown_tasks_and_bad_parameters() -> None:
    with pytest.raises(ConfigurationError, match="unknown task 'steping', did you mean 'stepping'"):
        EpisodeSpec(PAPER_STEPPING, 0, task="steping")
    with pytest.raises(ConfigurationError, match="P1 must be between"):
        EpisodeSpec((3.0, 1.3, 0.1, 1.0, 1.0), 0)


@pytest.mark.parametrize("seed", [-1, 1.5, True])
def test_spec_refuses_seeds_that_would_not_repeat(seed: object) -> None:
    with pytest.raises(ConfigurationError, match="seed must be a whole number from 0"):
        EpisodeSpec(PAPER_STEPPING, seed)  # type: ignore[arg-type]


def test_a_spec_does_not_follow_what_it_was_made_of() -> None:
    dimensions = {"hinge_height": 0.04}
    spec = EpisodeSpec(PAPER_STEPPING, np.int64(3), config=EpisodeConfig(dimensions=dimensions))  # type: ignore[arg-type]
    dimensions["hinge_height"] = 0.05
    assert spec.config.dimensions == {"hinge_height": 0.04} and type(spec.seed) is int


@pytest.mark.parametrize("value", [math.nan, math.inf, 2.1, -0.1, "1", True])
def test_parameters_that_cannot_be_are_named(value: object) -> None:
    with pytest.raises(ConfigurationError, match=r"parameter P4 must be between 0 and 2, not"):
        EpisodeSpec((1.0, 1.0, 1.0, value, 1.0), 0)  # type: ignore[arg-type]
    assert STEPPING.box.checked((0, 2, 1, 1, 1)) == (0.0, 2.0, 1.0, 1.0, 1.0)


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("push", 100, "push must be a Push, not 100"),
        ("dimensions", 3, "dimensions must be a Mapping, not 3"),
        ("stepping", 3, r"stepping must be 5 numbers \(P1 to P5\), not 3"),
    ],
)
def test_settings_of_another_type_are_named(field: str, value: object, expected: str) -> None:
    with pytest.raises(ConfigurationError, match=expected):
        BalanceConfig(**{field: value})  # type: ignore[arg-type]
