"""Pictures of a gait for TensorBoard: a gait cycle, and a short video as GIF."""

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path
from typing import Any

from PIL import Image
from tensorboard.compat.proto.summary_pb2 import Summary

from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.task_answers import controller_of
from sarah.episode.tasks import Task
from sarah.errors import ConfigurationError, SimulationError
from sarah.pictures.gait_figure import draw_gait_cycle
from sarah.pictures.style import only_png
from sarah.pictures.video import FRAMES_PER_SECOND, frame_times, frames, write_video

EPISODE_SECONDS = 10.0
"""Longest duration of the simulated episode, in s."""
VIDEO_SECONDS = 3.0
"""Duration of the video, which shows the end of the episode, in s."""
RGB = 3
"""Number by which TensorBoard knows the colours of a picture."""


def draw_gait(parameters: tuple[float, ...], task: Task[Any], config: EpisodeConfig) -> Summary:
    """Simulate an episode with seed 0, and draw its gait.

    :param parameters: values of the task's parameters, in order
    :param task: task that owns the parameters
    :param config: settings of the episode
    :return: a video, and a gait cycle if the robot completes one; no picture if the robot cannot even stand
    """
    short = dataclasses.replace(config, time_limit=min(EPISODE_SECONDS, config.time_limit))
    spec = EpisodeSpec(parameters, 0, task, short)
    try:
        trace = simulate(spec, record_trace=True).trace
    except SimulationError:  # the simulation diverges, which the learning curves show
        return Summary()
    assert trace is not None
    stepping, _ = controller_of(task, parameters, config)
    end = trace.time[-1]
    times = frame_times(max(trace.time[0], end - VIDEO_SECONDS), end, FRAMES_PER_SECOND[".gif"])
    with tempfile.TemporaryDirectory() as name, only_png():
        folder = Path(name)
        write_video(frames(trace, spec.robot, times, ground=spec.ground), folder / "video.gif")
        video = _picture("recommendation/video", folder / "video.gif")
        try:
            draw_gait_cycle(trace, stepping, folder / "cycle", config.controller)
        except ConfigurationError:  # the robot completes no gait cycle
            return Summary(value=[video])
        return Summary(value=[video, _picture("recommendation/cycle", folder / "cycle.png")])


def _picture(name: str, path: Path) -> Summary.Value:
    with Image.open(path) as picture:
        width, height = picture.size
    image = Summary.Image(width=width, height=height, colorspace=RGB, encoded_image_string=path.read_bytes())
    return Summary.Value(tag=name, image=image)
