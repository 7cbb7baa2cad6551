"""A copy of an environment is another one in the same state, with a world of its own; what cannot be copied says so."""

from typing import Any

import gymnasium
import numpy as np
import pytest
from laboratory import COARSE_PHYSICS, WAYS, need

from sarah import EpisodeConfig, PushedConfig
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.envs.registration import ENVIRONMENTS, OPERATION
from sarah.episode.workers import Workers
from sarah.errors import SimulationError
from sarah.operation.robot_in_operation import RobotInOperation
from sarah.operation.settings import SHIPPED, OperationConfig

COARSE = {"rate": 100, "solver_iterations": 5}


def made(name: str, engine: str) -> Any:
    need(engine)
    if name == OPERATION:
        robot = {"engine": engine, "physics": COARSE}
        return gymnasium.make(name, robot=robot, settle_seconds=0.5, measure_seconds=0.5).unwrapped
    task: dict[str, Any] = {} if "task" in ENVIRONMENTS[name] else {"task": "balance"}
    return gymnasium.make(name, engine=engine, physics=COARSE, time_limit=1.5, **task).unwrapped


@pytest.mark.parametrize(
    ("name", "engine", "way"),
    [
        *(("SarahStepping-v0", "pybullet", way) for way in WAYS),
        ("SarahBalance-v0", "mujoco", "deepcopy"),
        ("SarahEpisode-v0", "pybullet", "deepcopy"),
        (OPERATION, "pybullet", "copy"),
        (OPERATION, "mujoco", "deepcopy"),
    ],
)
def test_a_copied_environment_does_what_the_other_does(name: str, engine: str, way: str) -> None:
    env = made(name, engine)
    env.reset(seed=1)
    standing = WAYS[way](env)
    action = np.full(env.action_space.shape, 0.3, np.float32)
    reward = env.step(action)[1]
    stepped = WAYS[way](env)
    assert standing.step(action)[1] == reward
    following = [one.reset()[0].tobytes() for one in (env, standing, stepped)]
    assert len(set(following)) == 1


@pytest.mark.parametrize(("engine", "way"), [("pybullet", "pickle"), ("mujoco", "copy")])
def test_a_copied_operation_goes_on_as_the_other_does(engine: str, way: str) -> None:
    need(engine)
    settings = PushedConfig(engine=engine, physics=COARSE_PHYSICS)  # type: ignore[arg-type]
    robot = RobotInOperation(OperationConfig(robot=settings, settle_seconds=0.5, measure_seconds=0.5), 3)
    robot.run(SHIPPED)
    other = WAYS[way](robot)
    assert [other.run(SHIPPED), other.run(SHIPPED)] == [robot.run(SHIPPED), robot.run(SHIPPED)]


def test_episodes_in_flight_cannot_be_copied() -> None:
    env = EpisodeVecEnv("stepping", EpisodeConfig(), 2, 1, Workers())
    for way in WAYS.values():
        with pytest.raises(SimulationError, match=r"^EpisodeVecEnv holds simulated worlds"):
            way(env)
