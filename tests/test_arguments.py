"""Arguments and settings of another type, shape or range are refused in one line that names them."""

import dataclasses
import math
from collections.abc import Callable, Iterator
from typing import Annotated, Any, Literal, get_args

import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET

import sarah
from sarah.control.constants import ControllerConstants
from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.operation_env import SarahOperationEnv
from sarah.envs.sarah_env import SarahEnv, checked_action
from sarah.episode.push import DrawnPush, Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
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

STEPPING = SteppingParameters(0.4, 1.3, 0.1, 1.0, 1.0)


@dataclasses.dataclass(frozen=True)
class HighConfig(EpisodeConfig):
    height: Annotated[float, Within(0.0, 2.0, "m")] = 1.0
    foot: Literal["left", "right"] = "left"
    hops: bool = False
    push: Push = None  # type: ignore[assignment]  # that of the robot's size
    reach: Annotated[float, Sized(0.0, 10.0, "m", usual=2.0)] = None  # type: ignore[assignment]
    name: str | None = None


MISTAKES: dict[str, Callable[[], Any]] = {
    r"payload must be between 0 and 100 kg, not \(1, 2\)": lambda: EpisodeConfig(payload=(1, 2)),  # type: ignore
    r"operation.minutes must be between .*, not \(1, 2\)": lambda: OperationConfig(minutes=(1, 2)),  # type: ignore
    r"a change must be a Change, not 'a'": lambda: OperationConfig(changes=("a",)),  # type: ignore
    r"scheduler must be an address, such as .*, not ''": lambda: Workers(scheduler=""),
    r"constants must be a ControllerConstants": lambda: PatternGenerator(STEPPING, dt=0.01, constants="x"),  # type: ignore
    r"operated must be a robot in operation": lambda: SarahOperationEnv(operated="x"),  # type: ignore
    r"parameters must be 5 numbers .*, not \{": lambda: EpisodeSpec({0.4, 1.3, 0.1, 1.0, 2.0}, 0),  # type: ignore
    r"spec must be a EpisodeSpec, not 5": lambda: sarah.simulate(5),  # type: ignore
    r"spec must be a SessionSpec, not 5": lambda: sarah.run_session(5),  # type: ignore
    r"task must be a str, not 5": lambda: sarah.load_task(5),  # type: ignore
    r"an action must be 5 numbers .*, not \[-128": lambda: checked_action(np.full(5, -128, np.int8), 5),
    r"an action must be 5 numbers .*, not \[True": lambda: checked_action(np.full(5, True), 5),
    r"workers must be an executor": lambda: EpisodeVecEnv("stepping", EpisodeConfig(), 1, 1, 4),  # type: ignore
    r"unknown foot 'lef', did you mean 'left'\? \(allowed: left, right\)": lambda: HighConfig(foot="lef"),  # type: ignore
    r"hops must be a bool, not 1": lambda: HighConfig(hops=1),  # type: ignore
    r"push must be a Push, not 100": lambda: HighConfig(push=100),  # type: ignore
    r"a push must consist of finite numbers, three": lambda: DrawnPush((1, 2), 1, 1),  # type: ignore
}


@pytest.mark.parametrize("message", MISTAKES)
def test_a_mistaken_argument_is_named(message: str) -> None:
    with pytest.raises(ConfigurationError, match=message):
        MISTAKES[message]()


@NEEDS_PYBULLET
def test_pictures_are_drawn_where_numpy_raises_every_error() -> None:
    env = SarahEnv(render_mode="rgb_array", time_limit=2, physics={"rate": 100, "solver_iterations": 5})
    with np.errstate(all="raise"):
        env.reset(seed=0)
        assert env.render() is not None
    env.close()


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


def test_settings_go_with_the_robots_size_unless_given() -> None:
    half = HighConfig(dimensions=dimensions_alike(0.5, 0.1))
    assert half.reach == pytest.approx(1.0) and half.push.newtons[1] < 100.0 == HighConfig().push.newtons[1]
    assert HighConfig(dimensions=half.dimensions, reach=2.0).reach == HighConfig().reach == 2.0
    assert half.name is None
