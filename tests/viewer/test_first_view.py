"""What a page shows before anybody turns its camera."""

import dataclasses
import io
import math
import time

import numpy as np
import pytest
import yourdfpy
from laboratory import COARSE_PHYSICS

from sarah.robot.description import describe_robot
from sarah.runs.run_episodes import episode_of_parameters
from sarah.scenery.camera import View
from sarah.viewer.page import Page
from sarah.viewer.scene import FIRST_CAMERA, WINDOW, arrow, first_camera, status_place
from sarah.viewer.server import serving


@pytest.mark.parametrize(
    "dimensions",
    [
        {},
        {"thigh_length": 3.3},
        {"thigh_length": 0.033, "shank_length": 0.031},
        {"torso_height": 3.0},
        {"torso_width": 3.59},
        {"hip_offset": 1.3},
        {"forefoot_contact": 1.4},
    ],
    ids=str,
)
def test_robot_words_and_pushes_are_in_the_first_view(dimensions: dict[str, float]) -> None:
    robot = describe_robot(dimensions)
    model = yourdfpy.URDF.load(io.StringIO(robot.urdf), load_meshes=False)
    torso = np.array((0.0, 0.0, robot.standing_height))
    view = View(*WINDOW, first_camera(robot, model))
    nodes = [model.scene.graph.get(node) for node in model.scene.graph.nodes_geometry]
    shapes = [
        model.scene.geometry[mesh].vertices @ transform[:3, :3].T + transform[:3, 3] + torso
        for transform, mesh in nodes
    ]
    seen = [*shapes, status_place(robot, model)[None]]
    for turn in range(12):
        force = 150.0 * np.array((math.cos(turn * math.pi / 6), math.sin(turn * math.pi / 6), 0.0))
        seen.append(torso + arrow(force, robot.scale))
    pixels = view.pixels(np.concatenate(seen))
    assert (pixels > 0.0).all() and (pixels < WINDOW).all()
    assert np.ptp(pixels, axis=0).max() > 0.3 * WINDOW[1]  # and not far away


def test_a_robot_of_standard_size_is_seen_from_about_where_it_was() -> None:
    robot = describe_robot()
    model = yourdfpy.URDF.load(io.StringIO(robot.urdf), load_meshes=False)
    camera = first_camera(robot, model)
    assert camera.distance == pytest.approx(FIRST_CAMERA.distance, rel=0.1)
    assert camera._replace(distance=FIRST_CAMERA.distance) == FIRST_CAMERA


def test_an_arrow_is_as_long_as_its_force_is_strong_up_to_its_limit() -> None:
    lengths = [float(np.ptp(arrow(np.array((newtons, 0.0, 0.0)))[:, 0])) for newtons in (50.0, 100.0, 500.0, 1000.0)]
    assert lengths[1] == pytest.approx(2 * lengths[0]) and lengths[2] == lengths[3] > lengths[1]


def test_nothing_is_played_before_somebody_looks() -> None:
    episode = episode_of_parameters((0.4, 1.3, 0.1, 1.0, 1.0))
    short = dataclasses.replace(episode.spec.config, time_limit=3.0, physics=COARSE_PHYSICS)
    episode = episode.of(dataclasses.replace(episode.spec, config=short))
    with serving("127.0.0.1", 8080) as server:
        page = Page(server, [episode], episode)
        while not page.frames:
            time.sleep(0.02)
        time.sleep(0.5)
        assert page.frames == 1
        page.begin()
        time.sleep(0.5)
        assert page.frames > 3
        page.close()
