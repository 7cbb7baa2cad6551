"""Worlds of the engines are ours alone, whatever other code in the process does with the engines."""

import ctypes
import gc
import locale
import subprocess
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from laboratory import COARSE_PHYSICS, NEEDS_PYBULLET, WAYS

from sarah import STEPPING, EpisodeConfig, EpisodeSpec
from sarah.envs.episode_vec_env import EpisodeVecEnv
from sarah.episode.episode import Episode, simulate
from sarah.episode.workers import Workers
from sarah.errors import SimulationError
from sarah.robot.description import describe_robot
from sarah.simulation.build import simulator_of
from sarah.simulation.pybullet_world import pybullet
from sarah.simulation.randomisation import NOMINAL
from sarah.simulation.renderer import Renderer
from sarah.simulation.world import check_loaded

UPWARD = 0x800
"""Number of C's rounding mode FE_UPWARD on x86; other processors refuse it."""


def short(engine: Any) -> EpisodeConfig:
    return EpisodeConfig(engine=engine, physics=COARSE_PHYSICS, time_limit=1.5)


def spec(engine: str) -> EpisodeSpec:
    return EpisodeSpec(STEPPING.baseline, 3, STEPPING, short(engine))


def disturbed(engine: str, disturb: Callable[[Any], object]) -> EpisodeSpec:
    """An episode in which somebody does something to its simulator, after a tick."""

    def reward(tick: Any, config: EpisodeConfig) -> float:
        if tick.time < 1.015:
            disturb(tick.simulator)
        return 1.0

    return replace(spec(engine), task=replace(STEPPING, reward=reward))


def add_a_box(client: int) -> None:
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=(0.2, 0.2, 0.2), physicsClientId=client)
    pybullet.createMultiBody(1.0, box, physicsClientId=client)


def occupy(client: int) -> None:
    """Do what code does that has this client for itself."""
    pybullet.disconnect(client)
    taken = []
    while client not in taken:
        taken.append(pybullet.connect(pybullet.DIRECT))
    for other in taken:
        if other != client:
            pybullet.disconnect(other)
    for _ in range(2):
        pybullet.createMultiBody(1.0, physicsClientId=client)


DISTURBANCES: dict[str, Callable[[int], object]] = {
    "add a box": add_a_box,
    "disconnect": pybullet.disconnect if pybullet else print,
    "occupy": occupy,
    "hold the robot": lambda client: pybullet.createConstraint(
        1, -1, -1, -1, pybullet.JOINT_FIXED, (0, 0, 0), (0, 0, 0), (0, 0, 1), physicsClientId=client
    ),
    "advance": lambda client: pybullet.stepSimulation(physicsClientId=client),
    "weigh it down": lambda client: pybullet.changeDynamics(1, -1, mass=50, physicsClientId=client),
}


@NEEDS_PYBULLET
@pytest.mark.parametrize("disturbance", DISTURBANCES)
def test_what_others_do_to_a_pybullet_world_raises(disturbance: str) -> None:
    with pytest.raises(SimulationError, match=r"other code in this process has changed .*: it must leave client \d+"):
        simulate(disturbed("pybullet", lambda simulator: DISTURBANCES[disturbance](simulator.client)))


@pytest.mark.parametrize("array", ["data.qpos", "model.body_mass"])
def test_what_others_do_to_a_mujoco_world_raises(array: str) -> None:
    pytest.importorskip("mujoco")
    with pytest.raises(SimulationError, match="other code in this process has changed the robot's model in MuJoCo"):
        simulate(disturbed("mujoco", lambda simulator: np.copyto(attrgetter(array)(simulator)[:2], 7.0)))


@NEEDS_PYBULLET
@pytest.mark.parametrize("disturbance", ["add a box", "occupy"])
def test_episodes_repeat_whatever_others_did_to_a_kept_client(disturbance: str) -> None:
    with Episode(short("pybullet"), 3) as episode:
        client = episode.robot.simulation.client  # type: ignore[attr-defined]
        episode.stand()
        alone = episode.run(STEPPING.baseline)
    DISTURBANCES[disturbance](client)
    assert simulate(spec("pybullet")) == alone
    if disturbance == "occupy":
        assert pybullet.getNumBodies(physicsClientId=client) == 2  # it is theirs
        pybullet.disconnect(client)


@NEEDS_PYBULLET
def test_no_robot_is_where_code_works_that_names_no_client() -> None:
    build: Any = simulator_of("pybullet")
    clients = set()
    simulators = [build(describe_robot(), COARSE_PHYSICS, NOMINAL) for _ in range(12)]  # more than are kept
    assert 0 not in [simulator.client for simulator in simulators]
    for simulator in simulators:
        simulator.close()
    for _ in range(5):  # one that is forgotten gives its client back
        simulator = build(describe_robot(), COARSE_PHYSICS, NOMINAL)
        clients.add(simulator.client)
        del simulator
        gc.collect()
    assert len(clients) == 1


@NEEDS_PYBULLET
def test_bullets_contact_margin_is_its_own_in_other_worlds() -> None:
    other = pybullet.connect(pybullet.DIRECT)

    alone = simulate(spec("pybullet"))
    margin = partial(pybullet.setPhysicsEngineParameter, contactBreakingThreshold=0.05, physicsClientId=other)
    assert simulate(disturbed("pybullet", lambda _: margin())).final_position == alone.final_position
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=other)
    box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=(0.1,) * 3, physicsClientId=other)
    pybullet.createMultiBody(0.0, plane, physicsClientId=other)
    pybullet.createMultiBody(1.0, box, basePosition=(0.0, 0.0, 0.101), physicsClientId=other)
    pybullet.stepSimulation(physicsClientId=other)
    assert pybullet.getContactPoints(physicsClientId=other), "1 mm is near for Bullet, and far for our robot"
    pybullet.disconnect(other)


@NEEDS_PYBULLET
def test_a_locale_with_decimal_commas_changes_no_episode(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    try:
        subprocess.run(["localedef", "-i", "de_DE", "-f", "UTF-8", tmp_path / "de_DE.UTF-8"], capture_output=True)
        monkeypatch.setenv("LOCPATH", str(tmp_path))
        alone = simulate(spec("pybullet"))
        locale.setlocale(locale.LC_NUMERIC, "de_DE.UTF-8")
    except (OSError, locale.Error):
        pytest.skip("this machine cannot make the locale")
    try:
        assert simulate(spec("pybullet")) == alone
        assert locale.localeconv()["decimal_point"] == ","
    finally:
        locale.setlocale(locale.LC_NUMERIC, "C")


def test_a_robot_is_compared_with_its_description(engine: str) -> None:
    robot = describe_robot()
    heavier = replace(robot, masses={**robot.masses, "left_shank": 1.001 * robot.masses["left_shank"]})
    narrower = replace(robot, limits={**robot.limits, "right_hip_flexion": (-0.1, 0.1)})
    load, check = simulator_of(engine), partial(check_loaded, engine, robot, NOMINAL, robot.masses)
    for attempt, words in (
        (lambda: load(heavier, COARSE_PHYSICS, NOMINAL), r"loaded another robot .*: mass of left_shank is"),
        (lambda: load(narrower, COARSE_PHYSICS, NOMINAL), "lower limit of right_hip_flexion is"),
        (lambda: check(dict([*robot.limits.items()][1:]), (0.0, 0.0, -9.81)), "number of joints is 9 there, and sh"),
        (lambda: check(robot.limits, (0.0, 0.0, 0.0)), r"gravity along z is 0\.0"),
    ):
        with pytest.raises(SimulationError, match=words):
            attempt()


def test_a_process_that_rounds_upward_is_refused(engine: str) -> None:
    alone = simulate(spec(engine))
    libm = ctypes.CDLL(None)
    if libm.fesetround(UPWARD):
        pytest.skip("this processor has other numbers for its rounding modes")
    try:
        with pytest.raises(SimulationError, match="this process rounds sums up, down or towards 0"):
            simulate(spec(engine))
    finally:
        libm.fesetround(0)
    assert simulate(spec(engine)) == alone


@pytest.mark.parametrize("when", ["before", "during"])
def test_others_callbacks_of_mujoco_are_refused(when: str) -> None:
    mujoco = pytest.importorskip("mujoco")

    if when == "before":
        mujoco.set_mjcb_passive(lambda model, data: None)
    try:
        with pytest.raises(SimulationError, match=r"mjcb_passive, .*: remove it with mujoco.set_mjcb_passive\(None\)"):
            simulate(disturbed("mujoco", lambda _: mujoco.set_mjcb_passive(lambda model, data: None)))
    finally:
        mujoco.set_mjcb_passive(None)


def test_mujocos_warnings_of_other_models_still_come() -> None:
    mujoco = pytest.importorskip("mujoco")
    heard: list[str] = []
    mujoco.set_mju_user_warning(heard.append)
    try:
        simulate(spec("mujoco"))
        body = "<body><freejoint/><geom size='1'/></body>"
        model = mujoco.MjModel.from_xml_string(f"<mujoco><worldbody>{body}</worldbody></mujoco>")
        data = mujoco.MjData(model)
        data.qpos[0] = float("nan")
        mujoco.mj_step(model, data)
    finally:
        mujoco.set_mju_user_warning(None)
    assert heard


def test_what_holds_a_world_cannot_be_copied(engine: str) -> None:
    episode = Episode(short(engine), 0)
    others = [Renderer(describe_robot())] if engine == "pybullet" else []
    in_flight = EpisodeVecEnv("stepping", short(engine), 2, 1, Workers())
    for holder in (episode, episode.robot, episode.robot.simulation, in_flight, *others):
        for way in WAYS.values():
            with pytest.raises(SimulationError, match=f"^{type(holder).__name__} holds simulated worlds"):
                way(holder)
        holder.close()  # type: ignore[attr-defined]
