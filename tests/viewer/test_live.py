"""A robot that runs elsewhere, in the scene of the page."""

import itertools
import math

import numpy as np
import pytest
from listening import free_port, robot

from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.errors import RobotError
from sarah.remote.client import Client
from sarah.remote.endpoints import Endpoint
from sarah.viewer.live import LiveRobot
from sarah.viewer.server import serving

pytest.importorskip("zenoh")


def test_the_scene_follows_a_robot_until_it_has_gone() -> None:
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    with serving("127.0.0.1", 8080) as server:
        live = LiveRobot(server, PARAMETER_SETS["balance"].spec)
        with robot(endpoint) as loop:
            client = Client(endpoint)
            while loop.ticks < 200:  # from there on it steps
                live.show(next(client.telemetry()))
            told = list(itertools.islice(client.telemetry(), 3))
            for telemetry in told:
                live.show(telemetry)
        assert told[0].tick < told[1].tick < told[2].tick
        assert live.words.content.startswith("**stepping** (stood for a second)") and "P2 1.30" in live.words.content
        x, y, z = np.array(live.scene.stance.position)
        assert live.scene.stance.visible and math.hypot(x, y) < 0.5 and z == pytest.approx(0.002)
        with client, pytest.raises(RobotError, match=f"the robot at {endpoint.address} has gone"):
            next(client.telemetry(0.2))
