"""Arguments of another type or shape are refused in one line that names argument, value and what is allowed."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from laboratory import NEEDS_PYBULLET

import sarah
from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.operation_env import SarahOperationEnv
from sarah.envs.sarah_env import SarahEnv, checked_action
from sarah.episode.push import DrawnPush
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.workers import Workers
from sarah.errors import ConfigurationError
from sarah.operation.settings import OperationConfig

STEPPING = SteppingParameters(0.4, 1.3, 0.1, 1.0, 1.0)
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
