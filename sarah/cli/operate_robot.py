"""Sessions whose robot runs by itself, with ``sarah-robot --listen``."""

from __future__ import annotations

import sys
import time
import uuid
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sarah.cli.endpoints import endpoint_of
from sarah.errors import ConfigurationError, TrainingInterruptedError
from sarah.operation.settings import OperationConfig
from sarah.remote.client import Client
from sarah.remote.endpoints import Endpoint
from sarah.remote.identity import settings_of
from sarah.remote.remote_robot import RemoteRobot
from sarah.remote.requests import LearnedWith
from sarah.runs.config_files import first_difference
from sarah.runs.session import SessionSpec
from sarah.runs.session_robot import SessionRobot

if TYPE_CHECKING:
    from sarah.remote.answers import Identity
    from sarah.runs.session_folder import SessionFolder
    from sarah.training.operate import SessionResult

OF_THE_SESSION = (
    *("--robot", "--learner", "--minutes", "--seed", "--settle-seconds", "--measure-seconds", "--extended-from"),
    *("--gone-seconds", "--authority", "--certificate", "--key", "--out", "--task", "--resume", "--from"),
)
"""Options that have an effect with a robot that runs by itself."""
OF_THE_ROBOT = ("--gone-seconds", "--authority", "--certificate", "--key")
"""Options that have an effect only with one."""
IDENTITY_SECONDS = 5.0
"""Time to wait until a robot says what it is, in s."""
LOOK_SECONDS = 0.1
"""Time after which a learner that waits looks whether it is to stop, in s."""


def check_effect(arguments: Sequence[str], has_robot: bool) -> None:
    """Refuse options that have no effect.

    :param arguments: arguments of the command
    :param has_robot: whether the robot runs by itself
    :raises ConfigurationError: naming the option
    """
    for argument in arguments:
        name = argument.partition("=")[0].replace("_", "-")
        if has_robot and name.startswith("--") and name not in OF_THE_SESSION:
            raise ConfigurationError(f"{name} has no effect on a robot that runs by itself: leave it or --robot out")
        if not has_robot and name in OF_THE_ROBOT:
            raise ConfigurationError(f"{name} is for a robot that runs by itself: it needs --robot")


def robot_found(address: str, files: Sequence[Path | None], gone_seconds: float) -> tuple[SessionRobot, Identity]:
    """Ask a robot what it is.

    :param address: address at which it listens
    :param files: certificates for TLS: of the authority, own one, and key
    :param gone_seconds: time after which it is given up when it has gone, in s
    :return: what a session keeps of it, and what it says
    :raises RobotError: if nobody listens there
    """
    with Client(endpoint_of(address, *files)) as client:
        found = client.identity(IDENTITY_SECONDS)
    authority, certificate, key = ("" if path is None else str(path.resolve()) for path in files)
    own = (address, authority, certificate, key, gone_seconds, uuid.uuid4().hex)
    said = (found.robot, found.host, found.process, found.version, found.is_lockstep, found.has_score)
    return SessionRobot(*own, *said), found


def config_for(found: Identity, subject: LearnedWith | None, **times: Any) -> OperationConfig:
    """Settings of an operation of a robot that runs by itself.

    :param found: what the robot says it is
    :param subject: controller and robot that the first parameters were learned with, if that is known
    :param times: times of the operation, by name
    :raises ConfigurationError: if the first parameters were learned with another robot or controller
    """
    robot = settings_of(found)
    difference = "" if subject is None else subject.difference(LearnedWith.of(robot))
    if difference:
        raise ConfigurationError(
            f"the first parameters were learned with another robot or controller ({difference}): name a run folder of "
            "this robot, or numbers"
        )
    return OperationConfig(robot=robot, fall_seconds=0.0, **times)


@dataclass(frozen=True)
class FoundAgain:
    """Opens connections to the robot of a session, and compares it with the one that the session began with.

    :param robot: robot of the session
    :param spec: specification of the session, with the robot's settings
    :param say: function that is called with what differs, in words
    """

    robot: SessionRobot
    spec: SessionSpec
    say: Callable[[str], None]

    def __call__(self) -> Client:
        """Open a connection.

        :raises RobotError: if nobody listens
        :raises ConfigurationError: if it is a robot with another controller or of another size
        """
        client = Client(self._endpoint)
        try:
            self._compare(client.identity(IDENTITY_SECONDS))
        except BaseException:
            client.close()
            raise
        return client

    @property
    def _endpoint(self) -> Endpoint:
        robot = self.robot
        files = (Path(path) if path else None for path in (robot.authority, robot.certificate, robot.key))
        return endpoint_of(robot.endpoint, *files)

    def _compare(self, found: Identity) -> None:
        here, there = settings_of(found), self.spec.config.robot
        if difference := LearnedWith.of(here).difference(LearnedWith.of(there)):
            raise ConfigurationError(f"another robot listens at {self.robot.endpoint}: {difference}")
        if found.robot != self.robot.robot:
            self.say(f"the robot is now {found.robot}, and was {self.robot.robot}")
        elif (differs := first_difference(here, there)) is not None:
            self.say("the robot's {} is now {}, and was {}".format(*differs))


def operate_robot(folder: SessionFolder, spec: SessionSpec, robot: SessionRobot) -> Callable[..., SessionResult]:
    """Function that runs a session with a robot that runs by itself, of a watch and of one that says whether to stop.

    :param folder: folder of the session
    :param spec: specification of the session
    :param robot: its robot
    """
    from sarah.training.operate import operate

    def run(watch: Callable[..., None], interrupted: Callable[[], bool]) -> SessionResult:
        def pause(seconds: float) -> None:
            end = time.monotonic() + seconds
            while not interrupted() and time.monotonic() < end:
                time.sleep(LOOK_SECONDS)
            if interrupted():
                raise TrainingInterruptedError("the session was interrupted")

        def make_robot(config: OperationConfig, seed: int, watch: Any, journal: Any, observers: Any) -> RemoteRobot:
            connect = FoundAgain(robot, spec, say)
            return RemoteRobot(config, connect, robot.learner, watch, journal, robot.gone_seconds, say, pause)

        return operate(folder, spec, watch, interrupted, make_robot=make_robot)

    return run


def say(words: str) -> None:
    """Print a line about the robot, above the progress bar.

    :param words: the line
    """
    from tqdm import tqdm

    tqdm.write(f"{time.strftime('%H:%M:%S')}  {words}", file=sys.stderr)
