"""A robot that runs: what observers see of a tick, and when nothing happens any more."""

import pytest
from laboratory import NoPhysics

from sarah.control.pattern_generator import PhaseChange
from sarah.episode.episode import Episode
from sarah.episode.running_robot import Observer, RunningRobot
from sarah.episode.settings import EpisodeConfig
from sarah.robot.reading import Vector

PUSH = (50.0, 0.0, 0.0)


class Pushed(NoPhysics):
    """A simulator in which a push does nothing."""

    def push(self, force: Vector) -> None:
        pass


class Diary(Observer):
    """Writes down time, number of commands so far, and push."""

    def __init__(self) -> None:
        self.entries: list[tuple[float, int, Vector | None]] = []

    def sensed(self, robot: RunningRobot) -> None:
        self._write(robot, None)

    def decided(self, robot: RunningRobot, change: PhaseChange | None, force: Vector | None) -> None:
        self._write(robot, force)

    def _write(self, robot: RunningRobot, force: Vector | None) -> None:
        assert isinstance(robot.simulation, Pushed)
        self.entries.append((robot.simulation.time, len(robot.simulation.targets), force))


def test_an_observer_sees_a_tick_before_anything_moves() -> None:
    diary, robot = Diary(), RunningRobot(EpisodeConfig(), 0, build=Pushed)
    robot.observers = (diary,)
    robot.tick()
    robot.tick(PUSH)
    times, commands, forces = zip(*diary.entries, strict=True)
    assert times == pytest.approx((0.0, 0.0, 0.01, 0.01))
    assert commands == (0, 1, 1, 2)
    assert forces == (None, None, None, PUSH)
    robot.termination = "fell"
    robot.tick()
    assert robot.simulation.time == pytest.approx(0.02) and len(diary.entries) == 4


def test_a_with_block_closes_the_world_after_an_error_too() -> None:
    with pytest.raises(ZeroDivisionError), Episode(EpisodeConfig(), 0, build=NoPhysics) as episode:
        raise ZeroDivisionError
    assert isinstance(episode.robot.simulation, NoPhysics) and episode.robot.simulation.closed
