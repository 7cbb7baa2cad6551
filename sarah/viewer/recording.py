"""An episode as one HTML file that needs neither a server nor a network."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import viser

from sarah.episode.episode import simulate
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.errors import ConfigurationError
from sarah.runs.episode_words import told_settings
from sarah.viewer.playback import FRAMES_PER_SECOND
from sarah.viewer.scene import RobotScene


def record(
    server: viser.ViserServer,
    spec: EpisodeSpec,
    path: Path,
    progress: Callable[[float], object] = lambda _: None,
    recorded: Callable[[], EpisodeResult] | None = None,
) -> None:
    """Write an episode as one HTML file.

    :param server: server with an empty scene, which is filled
    :param spec: specification of the episode
    :param path: path of the file
    :param progress: function that is called with the finished share, from 0 to 1
    :param recorded: function that simulates it with a trace, if it is more than its specification says
    :raises ConfigurationError: if the file cannot be written
    """
    trace = (simulate(spec, record_trace=True) if recorded is None else recorded()).trace
    assert trace is not None
    scene = RobotScene(server, spec.robot)
    scene.load(trace, spec)
    scene.tell(told_settings(spec))
    recorder = server.get_scene_serializer()
    for time in np.arange(trace.time[0], trace.time[-1], 1.0 / FRAMES_PER_SECOND):
        scene.show(trace.tick_at(time))
        recorder.insert_sleep(1.0 / FRAMES_PER_SECOND)
        progress((time - trace.time[0]) / (trace.time[-1] - trace.time[0]))
    try:
        page = recorder.as_html().replace("<title>Viser</title>", "<title>SARAH</title>")
        path.write_text(page, encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"cannot write {path}: {error.strerror or error}") from error
