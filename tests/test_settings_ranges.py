"""Every number among the settings has a range on its field, and is refused beyond it."""

import dataclasses
import math
from collections.abc import Iterator
from typing import Annotated, Any, Literal, get_args

import pytest

from sarah.control.constants import ControllerConstants
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError
from sarah.operation.settings import OperationConfig
from sarah.ranges import Within, ranges_of, types_of
from sarah.robot.dimensions import dimensions_alike
from sarah.robot.scale import Sized
from sarah.runs.agent_settings import AGENT_SETTINGS
from sarah.runs.config import TrainingConfig
from sarah.simulation.physics import PyBulletPhysics
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.terrain import Terrain


@dataclasses.dataclass(frozen=True)
class HighConfig(EpisodeConfig):
    """Settings of a task of one's own."""

    height: Annotated[float, Within(0.0, 2.0, "m")] = 1.0
    foot: Literal["left", "right"] = "left"
    hops: bool = False
    push: Push = None  # type: ignore[assignment]  # that of the robot's size
    reach: Annotated[float, Sized(0.0, 10.0, "m", usual=2.0)] = None  # type: ignore[assignment]
    name: str | None = None


KINDS: list[Any] = [
    *(ControllerConstants, Push, HighConfig, OperationConfig, TrainingConfig, PyBulletPhysics, Randomisation, Terrain),
    *dict.fromkeys(AGENT_SETTINGS.values()),
]
OTHERS = {"dimensions", "extended_from"}
"""Numbers whose limits depend on others."""


def parts(kind: Any) -> Iterator[Any]:
    yield kind
    for part in get_args(kind):
        yield from parts(part)


@pytest.mark.parametrize("kind", KINDS)
def test_numbers_out_of_range_are_refused_by_name(kind: Any) -> None:
    numbers = {name for name, type_ in types_of(kind).items() if {int, float} & set(parts(type_))}
    assert numbers - OTHERS <= set(ranges_of(kind)) <= numbers
    for name, within in ranges_of(kind).items():
        default = getattr(kind(), name)
        for bad in (within.low - 1, 2 * within.high + 1, math.nan):
            value = (*default[:1], bad) if isinstance(default, tuple) else bad
            with pytest.raises(ConfigurationError) as refused:
                kind(**{name: value})
            key, _, message = str(refused.value).partition(" must be ")
            assert key.rpartition(".")[2] == name
            limits = f"between {within.low:.10g} and {within.high:.10g} {within.unit}".rstrip()
            assert message.startswith((limits, "a whole number, not ")) and "\n" not in message


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ({"foot": "lef"}, "unknown foot 'lef', did you mean 'left'? (allowed: left, right)"),
        ({"hops": 1}, "hops must be a bool, not 1"),
        ({"push": 100}, "push must be a Push, not 100"),
    ],
)
def test_names_switches_and_inner_settings_are_refused_by_name(wrong: Any, message: str) -> None:
    with pytest.raises(ConfigurationError) as refused:
        HighConfig(**wrong)
    assert str(refused.value) == message


def test_settings_go_with_the_robots_size_unless_given() -> None:
    half = HighConfig(dimensions=dimensions_alike(0.5, 0.1))
    assert half.reach == pytest.approx(1.0) and half.push.newtons[1] < 100.0 == HighConfig().push.newtons[1]
    assert HighConfig(dimensions=half.dimensions, reach=2.0).reach == HighConfig().reach == 2.0
    assert half.name is None
