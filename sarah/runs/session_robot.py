"""The robot of a session that does not simulate one: where it listens, and what it said it is."""

from __future__ import annotations

from dataclasses import dataclass

from sarah.remote.remote_robot import GONE_SECONDS


@dataclass(frozen=True)
class SessionRobot:
    """A robot that runs by itself, as it was when the session began.

    :param endpoint: address at which it listens
    :param authority: certificate of the authority that has signed both certificates, a path; empty without TLS
    :param certificate: own certificate, a path
    :param key: private key of that certificate, a path
    :param gone_seconds: time after which the robot is given up when it has gone, in s
    :param learner: name of the session's learner, by which the robot tells learners apart
    :param robot: its driver, or how it is simulated, in words
    :param host: computer on which its program ran
    :param process: name of that run of its program
    :param version: version of this package there
    :param is_lockstep: whether it waited between windows
    :param has_score: whether it knew its true score
    """

    endpoint: str = ""
    authority: str = ""
    certificate: str = ""
    key: str = ""
    gone_seconds: float = GONE_SECONDS
    learner: str = ""
    robot: str = ""
    host: str = ""
    process: str = ""
    version: str = ""
    is_lockstep: bool = False
    has_score: bool = False
