"""A robot that runs elsewhere, as it is now: its motion is estimated from the sensor signals of its telemetry."""

from __future__ import annotations

import viser

from sarah.episode.spec import EpisodeSpec
from sarah.episode.trace import Trace
from sarah.logs.played import Attitude
from sarah.operation.odometry import LegOdometry
from sarah.remote.answers import Telemetry
from sarah.remote.reporter import RATE
from sarah.robot.description import ANKLE_JOINTS
from sarah.robot.reading import STANDING, SensorReading
from sarah.viewer.scene import RobotScene


class LiveRobot:
    """The robot in a page's scene, and what it says beside it.

    :param server: server whose page is filled
    :param spec: specification with the dimensions of the robot
    """

    def __init__(self, server: viser.ViserServer, spec: EpisodeSpec) -> None:
        self.scene = RobotScene(server, spec.robot)
        """Scene with the robot."""
        self.words = server.gui.add_markdown("no telemetry yet")
        """What the robot does."""
        self._spec = spec
        self._attitude = Attitude([STANDING], 1.0 / RATE)
        self._odometry = LegOdometry(spec.robot.standing_height, 1.0 / RATE)

    def show(self, telemetry: Telemetry) -> None:
        """Show what the robot does now.

        :param telemetry: newest telemetry
        """
        self.words.content = "\n\n".join(_words(telemetry))
        if telemetry.reading is None:
            return
        reading = SensorReading(*[tuple(signal) for signal in telemetry.reading.values()])  # type: ignore[arg-type]
        self._attitude.tick(reading)
        self._odometry.tick(reading)
        height = self._attitude.height(reading, self._spec.robot.standing_height)
        row = {
            "time": telemetry.seconds,
            "position": (self._odometry.x, self._odometry.y, height),
            "orientation": self._attitude.orientation,
            "joints": reading.joints,
            "ankles": (0.0,) * len(ANKLE_JOINTS),
            "targets": reading.joints,
            "pressures": reading.pressures,
            "acceleration": reading.acceleration,
            "angular_rate": reading.angular_rate,
            "phase": telemetry.phase,
            "stance": telemetry.stance,
            "stable_x": 0.0,
            "tilt": telemetry.tilt,
            "rate": 0.0,
            "steps_per_second": telemetry.steps_per_second,
            "push": (0.0, 0.0, 0.0),
            "score": float("nan"),
        }
        self.scene.load(Trace.of([row]), self._spec)
        self.scene.show(0)


def _words(telemetry: Telemetry) -> list[str]:
    """Paragraphs about what a robot does."""
    reason = f" ({telemetry.reason})" if telemetry.reason else ""
    parameters = ", ".join(f"{name} {value:.2f}" for name, value in telemetry.parameters.items())
    return [
        f"**{telemetry.state}**{reason}",
        f"{telemetry.seconds:.1f} s, {telemetry.steps_per_second:.1f} steps per second, phase {telemetry.phase}",
        f"{telemetry.late_ticks} late ticks",
        parameters,
    ]
