"""The scene of the page, as far as it can be seen without a browser."""

import io
import math
import time
from collections.abc import Iterator
from dataclasses import replace
from typing import Any, cast

import numpy as np
import pytest
import yourdfpy
from laboratory import COARSE_PHYSICS

from sarah import BalanceConfig, EpisodeSpec, Push, Terrain, simulate
from sarah.episode.trace import Trace
from sarah.robot.description import describe_robot
from sarah.runs.run_episodes import episode_of_parameters
from sarah.scenery.camera import View
from sarah.viewer.page import Page
from sarah.viewer.plots import CHARTS, Plots
from sarah.viewer.scenario import Scenario
from sarah.viewer.scene import FIRST_CAMERA, WINDOW, RobotScene, arrow, channels, first_camera, status_place
from sarah.viewer.server import serving

SPEC = EpisodeSpec((0.0,) * 4, 0, "balance", BalanceConfig(time_limit=1.5, push=Push(0.0), physics=COARSE_PHYSICS))
SHORT_LEGS = replace(SPEC, config=replace(SPEC.config, dimensions={"thigh_length": 0.2}))


@pytest.fixture(scope="module")
def trace() -> Trace:
    return cast(Trace, simulate(SPEC, record_trace=True).trace)


@pytest.fixture(scope="module")
def scene() -> Iterator[RobotScene]:
    with serving("127.0.0.1", 8080) as server:
        yield RobotScene(server, SPEC.robot)


def test_every_push_has_its_arrow_and_words_while_it_acts(scene: RobotScene, trace: Trace) -> None:
    forces = np.zeros((len(trace), 3))
    forces[5:8], forces[30:] = (500.0, 0.0, 0.0), (0.0, -5.0, 0.0)
    scene.load(replace(trace, push=forces), SPEC)
    shown = []
    for tick in (0, 6, 49):
        scene.show(tick)
        visible = [force for force, arrow in scene.arrows.items() if arrow.visible]
        shown.append((visible, scene.status.text.split("\n")[0]))
    assert shown[0] == ([], "1.0 s · SHIFT, right stance leg · 0.0 steps/s · score so far 0.00")
    assert shown[1] == ([(500.0, 0.0, 0.0)], "push of 500 N to its right")
    assert shown[2] == ([(0.0, -5.0, 0.0)], "push of 5 N backward")


def test_robot_and_rough_ground_leave_with_their_episode(scene: RobotScene, trace: Trace) -> None:
    rough = replace(SPEC, config=replace(SPEC.config, terrain=Terrain(roughness=(0.02, 0.02))))
    scene.load(trace, rough)
    bumps, low = scene.bumps, scene.floor.position[2]
    assert bumps is not None and np.reshape(bumps.vertices, (-1, 3))[:, 2].min() == pytest.approx(low) and low < -0.01
    scene.load(trace, SPEC)
    assert scene.bumps is None and scene.floor.position[2] == 0.0
    for spec in (SHORT_LEGS, SPEC):
        scene.load(trace, spec)
        scene.show(0)
        assert scene.robot == spec.robot


def test_words_are_shown_and_a_fall_while_standing_has_no_stance(scene: RobotScene, trace: Trace) -> None:
    scene.load(replace(trace, phase=np.full(len(trace), "stand")), SPEC)
    scene.tell(["payload 5", "terrain.friction_left 0.2"])
    scene.show(0)
    assert not scene.stance.visible
    assert scene.status.text.startswith("payload 5, terrain.friction_left 0.2\n1.0 s")
    scene.tell([])


ROBOTS: list[dict[str, float]] = [
    *({}, {"thigh_length": 3.3}, {"thigh_length": 0.033, "shank_length": 0.031}, {"torso_height": 3.0}),
    *({"torso_width": 3.59}, {"hip_offset": 1.3}, {"forefoot_contact": 1.4}),
]


@pytest.mark.parametrize("dimensions", ROBOTS, ids=str)
def test_robot_words_and_pushes_are_in_the_first_view(dimensions: dict[str, float]) -> None:
    robot = describe_robot(dimensions)
    model = yourdfpy.URDF.load(io.StringIO(robot.urdf), load_meshes=False)
    torso, camera = np.array((0.0, 0.0, robot.standing_height)), first_camera(robot, model)
    nodes = [model.scene.graph.get(node) for node in model.scene.graph.nodes_geometry]
    shapes = [
        model.scene.geometry[mesh].vertices @ transform[:3, :3].T + transform[:3, 3] + torso
        for transform, mesh in nodes
    ]
    seen = [*shapes, status_place(robot, model)[None]]
    for turn in range(12):
        force = 150.0 * np.array((math.cos(turn * math.pi / 6), math.sin(turn * math.pi / 6), 0.0))
        seen.append(torso + arrow(force, robot.scale))
    pixels = View(*WINDOW, camera).pixels(np.concatenate(seen))
    assert (pixels > 0.0).all() and (pixels < WINDOW).all()
    assert np.ptp(pixels, axis=0).max() > 0.3 * WINDOW[1]  # and not far away
    if not dimensions:  # seen from about where it was
        assert camera.distance == pytest.approx(FIRST_CAMERA.distance, rel=0.1)
        assert camera._replace(distance=FIRST_CAMERA.distance) == FIRST_CAMERA


def test_an_arrow_is_as_long_as_its_force_up_to_its_limit() -> None:
    lengths = [float(np.ptp(arrow(np.array((newtons, 0.0, 0.0)))[:, 0])) for newtons in (50.0, 100.0, 500.0, 1000.0)]
    assert lengths[1] == pytest.approx(2 * lengths[0]) and lengths[2] == lengths[3] > lengths[1]
    assert channels("#0172B3") == (1, 0x72, 0xB3)


def test_plots_show_their_window_of_time_and_its_values(trace: Trace) -> None:
    quick = replace(SPEC, config=replace(SPEC.config, step_frequency=2.0))
    with serving("127.0.0.1", 8080) as server:
        plots = Plots(server.gui)
        plots.load(trace, Scenario.of(quick))
        plots.show(1.2)
        charts: Any = plots.charts
        for chart, shown in zip(CHARTS, charts, strict=True):
            low, high = shown.scales["y"]["range"]
            assert high - low > 0.99 * chart.smallest_span and all(
                low < np.median(line) < high for line in shown.data[4:]
            )
            assert (
                shown.scales["x"]["range"] == (trace.time[0], trace.time[-1]) == (shown.data[0][0], shown.data[0][-1])
            )
    assert set(shown.data[-1]) == {2.0}  # the frequency that is best for the reward


def test_nothing_is_played_before_somebody_looks() -> None:
    episode = episode_of_parameters((0.4, 1.3, 0.1, 1.0, 1.0))
    short = replace(episode.spec.config, time_limit=3.0, physics=COARSE_PHYSICS)
    episode = episode.of(replace(episode.spec, config=short))
    with serving("127.0.0.1", 8080) as server:
        page = Page(server, [episode], episode)
        deadline = time.monotonic() + 60.0
        while not page.frames and time.monotonic() < deadline:
            time.sleep(0.02)
        time.sleep(0.5)
        assert page.frames == 1
        page.begin()
        time.sleep(0.5)
        assert page.frames > 3
        page.close()
