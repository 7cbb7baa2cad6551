"""The relay to ROS, with stand-ins for ROS: what the robot sends arrives, and a push is answered."""

import runpy
import sys
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from listening import free_port, robot

from sarah.remote.endpoints import Endpoint

RELAY = Path(__file__).parents[2] / "examples" / "relay_to_ros.py"


class Node:
    """A stand-in for ROS's node, which keeps what is published and logged."""

    def __init__(self, name: str) -> None:
        self.published: list[str] = []
        self.logged: list[str] = []

    def create_publisher(self, kind: type, topic: str, depth: int) -> SimpleNamespace:
        return SimpleNamespace(publish=lambda message: self.published.append(message.data))

    def create_subscription(self, kind: type, topic: str, callback: Any, depth: int) -> None:
        self.callback = callback

    def get_logger(self) -> SimpleNamespace:
        return SimpleNamespace(info=self.logged.append, error=self.logged.append)


def spin(node: Node) -> None:
    node.callback(SimpleNamespace(data=[0.4, 1.3, 0.1, 1.0, 1.0, 0.5, 0.0, 0.5, 0.0]))
    end = time.monotonic() + 10.0
    while not (node.published and node.logged) and time.monotonic() < end:
        time.sleep(0.01)
    assert '"state"' in node.published[0] and node.logged[0].startswith("applied at tick")


def test_it_relays_telemetry_and_pushes(monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("zenoh")
    modules: dict[str, dict[str, Any]] = {
        "rclpy": {"init": lambda: None, "spin": spin},
        "rclpy.node": {"Node": Node},
        "std_msgs": {},
        "std_msgs.msg": {"Float64MultiArray": object, "String": SimpleNamespace},
    }
    for name, content in modules.items():
        module = ModuleType(name)
        vars(module).update(content)
        monkeypatch.setitem(sys.modules, name, module)
    endpoint = Endpoint(f"tcp/127.0.0.1:{free_port()}")
    monkeypatch.setattr("sys.argv", [str(RELAY), endpoint.address])
    with robot(endpoint):
        runpy.run_path(str(RELAY), run_name="__main__")
