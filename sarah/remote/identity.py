"""What a robot that listens says of itself, and what a learner makes of it."""

from __future__ import annotations

import dataclasses
import socket
import uuid
from dataclasses import asdict

from sarah.episode.from_mapping import from_mapping
from sarah.episode.push import NO_PUSH, PushedConfig
from sarah.episode.settings import EpisodeConfig
from sarah.remote.answers import Identity
from sarah.versions import versions


def identity_of(config: EpisodeConfig, robot: str, is_lockstep: bool, has_score: bool) -> Identity:
    """What a robot of this process is.

    :param config: settings of the robot
    :param robot: its driver, or how it is simulated, in words
    :param is_lockstep: whether it waits for a learner between windows
    :param has_score: whether it knows its true score
    """
    shared = {item.name: getattr(config, item.name) for item in dataclasses.fields(EpisodeConfig)}
    push = config.push if isinstance(config, PushedConfig) else NO_PUSH
    settings = asdict(PushedConfig(**shared, push=push))
    return Identity(
        robot, socket.gethostname(), uuid.uuid4().hex, versions(())["sarah"], is_lockstep, has_score, settings
    )


def settings_of(identity: Identity) -> PushedConfig:
    """Settings of a robot that said what it is.

    :param identity: what it said
    :raises ConfigurationError: if this version knows no such settings
    """
    return from_mapping(PushedConfig(), identity.settings, "settings of the robot: ")
