"""What parameters do, as pictures for TensorBoard: a gait cycle, and a short video as GIF, which it plays."""

from __future__ import annotations

import dataclasses
import tempfile
from dataclasses import dataclass
from pathlib import Path

from PIL import Image

from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import TASKS
from sarah.errors import ConfigurationError, SimulationError
from sarah.pictures.gait_figure import draw_gait_cycle
from sarah.pictures.video import FRAMES_PER_SECOND, frame_times, frames, write_video
from sarah.robot.description import describe_robot

EPISODE_SECONDS = 10.0
"""Simulated at most."""
VIDEO_SECONDS = 3.0
"""The last ones of the episode are filmed."""


@dataclass(frozen=True)
class Picture:
    """An encoded picture.

    :param name: that TensorBoard shows it under
    :param width: in pixels
    :param height: in pixels
    :param content: of its file, PNG or GIF
    """

    name: str
    width: int
    height: int
    content: bytes


def draw_gait(parameters: tuple[float, ...], task: str, config: EpisodeConfig) -> list[Picture]:
    """Simulate parameters on seed 0, and draw what they do.

    :param parameters: to draw
    :param task: whose parameters they are
    :param config: settings of the episode
    :return: a video, and a gait cycle if the robot makes one; nothing if it does not even stand
    """
    short = dataclasses.replace(config, time_limit=min(EPISODE_SECONDS, config.time_limit))
    try:
        trace = simulate(EpisodeSpec(parameters, 0, task, short), record_trace=True).trace
    except SimulationError:  # it diverges: the curves show that
        return []
    assert trace is not None
    stepping, _ = TASKS[task].controller_parameters(parameters, config)
    end = trace.time[-1]
    times = frame_times(max(trace.time[0], end - VIDEO_SECONDS), end, FRAMES_PER_SECOND[".gif"])
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write_video(frames(trace, describe_robot(config.dimensions), times), folder / "video.gif")
        pictures = [_picture("gait/video", folder / "video.gif")]
        try:
            draw_gait_cycle(trace, stepping, folder / "cycle", config.controller)
        except ConfigurationError:  # it makes no step
            return pictures
        return [*pictures, _picture("gait/cycle", folder / "cycle.png")]


def _picture(name: str, path: Path) -> Picture:
    with Image.open(path) as picture:
        return Picture(name, picture.width, picture.height, path.read_bytes())
