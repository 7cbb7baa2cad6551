"""An episode as a video: the robot from its front, a close view of its feet, and the state of the pattern generator."""

from __future__ import annotations

import os
import uuid
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np
from PIL import Image, ImageColor

from sarah.episode.trace import Trace
from sarah.errors import ConfigurationError
from sarah.files import check_file, check_name
from sarah.pictures.colours import LEFT, PHASE_COLOURS, PUSH, RIGHT
from sarah.pictures.overlay import Overlay
from sarah.robot.description import ANKLE_JOINTS, RobotDescription
from sarah.robot.reading import ACTUATED_JOINTS, Vector
from sarah.scenery.camera import Camera, View
from sarah.scenery.ground import LEVEL, Ground
from sarah.scenery.push_arrow import arrow
from sarah.simulation.renderer import Renderer

SUFFIXES = (".mp4", ".gif")
WIDTH, HEIGHT = 1024, 576
SAMPLES = 2 / 3
"""Samples of the robot along each side of a pixel, which take most of a frame's time."""
FEET_CAMERA = Camera(height=0.11, distance=0.85, yaw=180.0, pitch=-4.0)
FEET_WIDTH, FEET_HEIGHT, FEET_MARGIN = 280, 165, 20
"""Size of the close view of the feet, and its distance from the lower right corner, in pixels."""
FRAMES_PER_SECOND = {".mp4": 25.0, ".gif": 20.0}
GIF_SIZE = (640, 360)
"""Size of a GIF, in pixels: smaller than a video, because GIF files are large."""
GIF_COLOURS = 200
TEXT_WIDTH = 228
"""Width of the column of text on the left, in pixels, which the robot leaves free, and as much on the right."""
Pose = tuple[Vector, tuple[float, float, float, float], dict[str, float]]
POSES_PER_SECOND = 25.0
"""Number of poses in a second of an episode that the cameras are chosen for."""


def frame_times(begin: float, end: float, frames_per_second: float, speed: float = 1.0) -> np.ndarray:
    """Simulated times of the frames of a video, in s.

    :param begin: simulated time of the first frame, in s
    :param end: simulated time that no frame exceeds, in s
    :param frames_per_second: frames per second of the video
    :param speed: speed of the video: 0.5 is half as fast as real time
    """
    count = int((end - begin) * frames_per_second / speed + 1e-6) + 1
    return begin + np.arange(count) * speed / frames_per_second


def frames(
    trace: Trace,
    robot: RobotDescription,
    times: Iterable[float],
    caption: str = "",
    ground: Ground = LEVEL,
) -> Iterator[Image.Image]:
    """Draw frames of an episode.

    :param trace: trace of the episode
    :param robot: robot of the episode
    :param times: simulated times of the frames, in s
    :param caption: text in the lower left corner
    :param ground: ground of the episode
    :return: RGB pictures of 1024 x 576 pixels
    """
    renderer = Renderer(robot, SAMPLES)
    try:
        camera, feet_camera = cameras(trace, robot, renderer, ground)
        overlay = Overlay(trace, View(WIDTH, HEIGHT, camera), caption, TEXT_WIDTH, robot.scale)
        for time in times:
            tick = trace.tick_at(time)
            pose = _pose(trace, tick)
            picture = renderer.draw(*pose, WIDTH, HEIGHT, camera)
            feet = renderer.draw(*pose, FEET_WIDTH, FEET_HEIGHT, feet_camera)
            bottom, right = HEIGHT - FEET_MARGIN, WIDTH - FEET_MARGIN
            top, left = bottom - FEET_HEIGHT, right - FEET_WIDTH
            picture[top - 2 : bottom + 2, left - 2 : right + 2] = 170
            picture[top:bottom, left:right] = feet
            frame = Image.fromarray(picture)
            overlay.draw(frame, tick)
            yield frame
    finally:
        renderer.close()


def cameras(trace: Trace, robot: RobotDescription, renderer: Renderer, ground: Ground = LEVEL) -> tuple[Camera, Camera]:
    """Cameras of an episode's frames: one sees the robot and its push the whole time, the other one its feet.

    Both stand still. They stand farther away than usual only if the episode needs it.

    :param trace: trace of the episode
    :param robot: robot of the episode
    :param renderer: renderer of the robot
    :param ground: ground of the episode
    """
    seen, feet = [], []
    for time in frame_times(trace.time[0], trace.time[-1], POSES_PER_SECOND):
        pose = _pose(trace, trace.tick_at(time))
        seen.append(renderer.seen(*pose, ground))
        feet.append(renderer.seen(*pose, ground, only_feet=True))
    camera = renderer.camera._replace(ground=ground).seeing(np.concatenate(seen), WIDTH - 2 * TEXT_WIDTH, HEIGHT)
    shown = [(tick, force) for tick, force in enumerate(trace.shown_pushes()) if force is not None]
    if shown:
        arrows = [arrow(trace.position[tick], np.array(force), robot.scale) for tick, force in shown]
        camera = camera.seeing(np.concatenate(arrows), WIDTH, HEIGHT)
    feet_camera = FEET_CAMERA.scaled(robot.scale.length)._replace(ground=ground)
    return camera, feet_camera.seeing(np.concatenate(feet), FEET_WIDTH, FEET_HEIGHT)


def _pose(trace: Trace, tick: int) -> Pose:
    """Position, orientation and joints at a tick."""
    joints = dict(zip(ACTUATED_JOINTS + ANKLE_JOINTS, (*trace.joints[tick], *trace.ankles[tick]), strict=True))
    return tuple(trace.position[tick]), tuple(trace.orientation[tick]), joints


def check_path(path: Path) -> None:
    """Refuse a file that no video can be written to, before the video is drawn.

    :param path: path of the file
    :raises ConfigurationError: if it is neither MP4 nor GIF, its folder does not exist, or the extra is not installed
    """
    if path.suffix not in SUFFIXES:
        raise ConfigurationError(f"a video must end in {' or '.join(SUFFIXES)}, not {path.name!r}")
    check_file(path)
    if path.suffix == ".mp4":
        try:
            import imageio_ffmpeg  # noqa: F401
        except ImportError:
            raise ConfigurationError("MP4 needs the extra video: pip install '.[video]' in the clone") from None


def write_video(pictures: Iterable[Image.Image], path: Path) -> None:
    """Write frames as MP4 (H.264), or as a repeating GIF, which is smaller.

    The file appears when it is complete.

    :param pictures: frames of 1024 x 576 pixels, at the rate of :data:`FRAMES_PER_SECOND`
    :param path: path of the file
    :raises ConfigurationError: if it cannot be written
    """
    check_name(path)
    unfinished = path.with_name(f".{uuid.uuid4().hex}{path.suffix}")  # as long as it may be, whatever the other name
    try:
        (_write_mp4 if path.suffix == ".mp4" else _write_gif)(pictures, unfinished)
        os.replace(unfinished, path)
    except OSError as error:
        raise ConfigurationError(f"cannot write {path}: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            unfinished.unlink()


def _write_mp4(pictures: Iterable[Image.Image], path: Path) -> None:
    from imageio_ffmpeg import count_frames_and_secs, write_frames

    fps = FRAMES_PER_SECOND[".mp4"]
    options = ["-preset", "veryfast", "-tune", "animation", "-movflags", "+faststart", "-threads", "1"]
    # In a name of its own, ffmpeg takes what is before a colon for a protocol, and a dash for standard output.
    name, written = f"file:{path.absolute()}", 0
    writer = write_frames(name, (WIDTH, HEIGHT), fps=fps, codec="libx264", quality=6, output_params=options)
    writer.send(None)
    try:
        for picture in pictures:
            written += 1
            try:
                writer.send(picture.tobytes())
            except OSError:  # ffmpeg has stopped, and this frame will be missed
                break
    finally:
        writer.close()
    try:
        found = count_frames_and_secs(name)[0]  # nobody else tells how ffmpeg has ended
    except RuntimeError:
        found = 0
    if found != written:
        raise OSError(f"ffmpeg wrote {found} of {written} frames; the disk may be full")


def _write_gif(pictures: Iterable[Image.Image], path: Path) -> None:
    shrunk = [picture.resize(GIF_SIZE, Image.Resampling.LANCZOS) for picture in pictures]
    palette = _palette(shrunk)
    first, *others = (picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in shrunk)
    first.save(path, save_all=True, append_images=others, duration=round(1000 / FRAMES_PER_SECOND[".gif"]), loop=0)


def _palette(pictures: list[Image.Image]) -> Image.Image:
    """Make one palette for all frames, which would flicker otherwise, of some frames and all colours with a meaning."""
    samples = [np.asarray(picture) for picture in pictures[:: max(1, len(pictures) // 6)]]
    colours = np.array([ImageColor.getrgb(name) for name in (LEFT, RIGHT, PUSH, *PHASE_COLOURS.values())], np.uint8)
    swatches = np.tile(colours.repeat(60, axis=0)[:, np.newaxis], (GIF_SIZE[0], 1))
    return Image.fromarray(np.concatenate([*samples, swatches])).quantize(GIF_COLOURS)
