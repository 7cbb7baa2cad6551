"""The scene of the page, as far as it can be seen without a browser."""

import dataclasses
from collections.abc import Iterator

import numpy as np
import pytest
from laboratory import COARSE_PHYSICS

from sarah.episode.episode import simulate
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BalanceConfig
from sarah.episode.trace import Trace
from sarah.simulation.terrain import Terrain
from sarah.viewer.scene import RobotScene
from sarah.viewer.server import serving

SPEC = EpisodeSpec((0.0,) * 4, 0, "balance", BalanceConfig(time_limit=1.5, push=Push(0.0), physics=COARSE_PHYSICS))
SHORT_LEGS = dataclasses.replace(SPEC, config=dataclasses.replace(SPEC.config, dimensions={"thigh_length": 0.2}))


@pytest.fixture(scope="module")
def trace() -> Trace:
    found = simulate(SPEC, record_trace=True).trace
    assert found is not None
    return found


@pytest.fixture(scope="module")
def scene() -> Iterator[RobotScene]:
    with serving("127.0.0.1", 8080) as server:
        yield RobotScene(server, SPEC.robot)


def test_every_push_has_its_arrow_and_words_while_it_acts(scene: RobotScene, trace: Trace) -> None:
    forces = np.zeros((len(trace), 3))
    forces[5:8], forces[30:] = (500.0, 0.0, 0.0), (0.0, -5.0, 0.0)
    scene.load(dataclasses.replace(trace, push=forces), SPEC)
    shown = []
    for tick in (0, 6, 49):
        scene.show(tick)
        visible = [force for force, arrow in scene.arrows.items() if arrow.visible]
        shown.append((visible, scene.status.text.split("\n")[0]))
    assert shown[0] == ([], "1.0 s · SHIFT, right stance leg · 0.0 steps/s · score so far 0.00")
    assert shown[1] == ([(500.0, 0.0, 0.0)], "push of 500 N to its right")
    assert shown[2] == ([(0.0, -5.0, 0.0)], "push of 5 N backward")


def test_an_episode_of_another_robot_shows_that_robot(scene: RobotScene, trace: Trace) -> None:
    scene.load(trace, SPEC)
    for spec in (SHORT_LEGS, SPEC):
        scene.load(trace, spec)
        scene.show(0)
        assert scene.robot == spec.robot


def test_rough_ground_is_drawn_and_leaves_with_its_episode(scene: RobotScene, trace: Trace) -> None:
    rough = dataclasses.replace(SPEC, config=dataclasses.replace(SPEC.config, terrain=Terrain(roughness=(0.02, 0.02))))
    scene.load(trace, rough)
    bumps = scene.bumps
    assert bumps is not None
    assert np.reshape(bumps.vertices, (-1, 3))[:, 2].min() == pytest.approx(scene.floor.position[2])
    assert scene.floor.position[2] < -0.01
    scene.load(trace, SPEC)
    assert scene.bumps is None and scene.floor.position[2] == 0.0


def test_what_no_scene_shows_is_written_above_the_robot(scene: RobotScene, trace: Trace) -> None:
    scene.load(trace, SPEC)
    scene.tell(["payload 5", "terrain.friction_left 0.2"])
    scene.show(0)
    assert scene.status.text.startswith("payload 5, terrain.friction_left 0.2\n1.0 s")
    scene.tell([])


def test_a_robot_that_fell_while_it_stood_has_no_stance(scene: RobotScene, trace: Trace) -> None:
    scene.load(dataclasses.replace(trace, phase=np.full(len(trace), "stand")), SPEC)
    scene.show(0)
    assert not scene.stance.visible
