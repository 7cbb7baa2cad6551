"""Every program of ``examples/`` is short, says what one sees, and runs."""

import ast
import runpy
import sys
import time
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest
from laboratory import need
from listening import free_port, robot

from sarah.remote.endpoints import Endpoint

EXAMPLES = Path(__file__).parents[2] / "examples"
LONGEST = 40
ENGINES = {"two_engines": ("pybullet", "mujoco")}
ARGUMENTS = {"naf_on_pendulum": ("100",)}
WITHOUT_ROS = ("relay_to_ros",)
"""Examples that have a test of their own, below."""


@pytest.mark.parametrize("path", sorted(EXAMPLES.glob("*.py")), ids=lambda path: path.stem)
def test_an_example_is_short_and_listed_and_one_sees_something(
    path: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for engine in ENGINES.get(path.stem, ()):
        need(engine)
    text = path.read_text()
    assert len(text.splitlines()) <= LONGEST and f"({path.name})" in (EXAMPLES / "README.md").read_text()
    assert "\nOne sees " in (ast.get_docstring(ast.parse(text)) or "")
    if path.stem in WITHOUT_ROS:
        return
    monkeypatch.setattr("sys.argv", [str(path), *ARGUMENTS.get(path.stem, ())])
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    runpy.run_path(str(path), run_name="__main__")
    lines = capsys.readouterr().out.splitlines()
    assert lines
    if path.stem == "push_and_recover":  # locked hips do not, and the hip law does
        assert "left_box" in lines[0] and "time_limit" in lines[1]


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
