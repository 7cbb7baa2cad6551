"""Draws the pictures of README and docs: ``python docs/pictures.py`` writes them beside this file."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image, ImageColor, ImageDraw, ImageFont

from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.ending import ending_words
from sarah.episode.episode import simulate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.result import EpisodeResult
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.pictures.colours import PUSH
from sarah.pictures.dimension_figure import draw_dimensions
from sarah.pictures.gait_figure import draw_gait_cycle, gait_cycle
from sarah.pictures.overlay import INK
from sarah.pictures.robot_figure import draw_robot
from sarah.pictures.state_machine_figure import draw_state_machine
from sarah.pictures.video import FRAMES_PER_SECOND, frame_times, frames, write_video
from sarah.robot.description import ANKLE_JOINTS, describe_robot
from sarah.robot.dimensions import default_dimensions
from sarah.robot.reading import ACTUATED_JOINTS
from sarah.scenery.camera import Camera, View
from sarah.scenery.push_arrow import arrow, draw_arrow
from sarah.simulation.randomisation import Randomisation
from sarah.simulation.renderer import Renderer
from sarah.simulation.terrain import Terrain

HERE = Path(__file__).parent
CYCLES = 4
"""Number of gait cycles in the video, which so repeats without a jump."""
GROUNDS = {
    "slope": Terrain(slope_degrees=(8.0, 8.0), direction_degrees=(0.0, 0.0)),
    "bumps": Terrain(roughness=(0.015, 0.015)),
}
"""Grounds in pictures, by the picture's name."""
GROUND_SECONDS = 3.0
"""Simulated time of these pictures, in s."""
SHIPPED = PARAMETER_SETS["balance"].spec
CAPTIONS = {(0.0,) * 4: "hips locked", SHIPPED.parameters: "hips as NAF learned"}
"""What stands above the two robots that meet the same push, by their V1 to V4."""
SEED, NEWTONS = 76, 100.0
BEGIN, END, RATE = 1.0, 5.0, 20
"""Simulated times of their picture, in s, and frames per second: the push comes after some 0.4 s of stepping."""
WIDTH, HEIGHT, CAMERA = 400, 380, Camera(height=0.54, distance=2.15, yaw=170.0, pitch=-7.0)
"""Size of each robot's half, in pixels, and what it shows."""
COLOURS = 128
FONT = ImageFont.truetype(Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans-Bold.ttf", 17)


def draw_ground_picture(terrain: Terrain, path: Path) -> None:
    """Draw the robot while it steps on some ground.

    :param terrain: the ground
    :param path: path of the picture
    """
    config = BALANCE.config_of(SHIPPED.config, terrain=terrain, time_limit=GROUND_SECONDS + 1.0, push=Push((0.0, 0.0)))
    spec = EpisodeSpec(SHIPPED.parameters, 0, BALANCE, config)
    trace = simulate(spec, record_trace=True).trace
    assert trace is not None
    (picture,) = frames(trace, spec.robot, [GROUND_SECONDS], ground=spec.ground)
    picture.save(path)


def draw_push_recovery(path: Path) -> None:
    """Draw two robots that step in place and meet the same push: with locked hips, and with what NAF learned."""
    config = BALANCE.config_of(SHIPPED.config, push=Push(newtons=NEWTONS), time_limit=10.0)
    halves = []
    for parameters, caption in CAPTIONS.items():
        result = simulate(EpisodeSpec(parameters, SEED, BALANCE, config), record_trace=True)
        assert result.survived is (parameters == SHIPPED.parameters), "another seed shows the difference"
        halves.append(film(result, caption))
    line = np.full((HEIGHT, 2, 3), 200, np.uint8)
    pictures = [Image.fromarray(np.hstack([left, line, right])) for left, right in zip(*halves, strict=True)]
    palette = palette_of(pictures)
    first, *others = (picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures)
    first.save(path, save_all=True, append_images=others, duration=1000 // RATE, loop=0)


def film(result: EpisodeResult, caption: str) -> list[np.ndarray]:
    """Draw one robot, whose it is, its push, and how its episode ended; then it stays as it ended."""
    trace = result.trace
    assert trace is not None
    renderer, pushes, pictures = Renderer(describe_robot()), trace.shown_pushes(), []
    for time in np.arange(BEGIN, END, 1.0 / RATE):
        tick = trace.tick_at(min(time, trace.time[-1]))
        joints = dict(zip(ACTUATED_JOINTS + ANKLE_JOINTS, (*trace.joints[tick], *trace.ankles[tick]), strict=True))
        pose = tuple(trace.position[tick]), tuple(trace.orientation[tick]), joints
        picture = Image.fromarray(renderer.draw(*pose, WIDTH, HEIGHT, CAMERA))
        pen, ending = ImageDraw.Draw(picture), ending_words(result.termination) if time > trace.time[-1] else ""
        pen.multiline_text((12, 10), f"{caption}\n{ending}", font=FONT, fill=INK)
        force = pushes[tick]
        if force is not None and not ending:
            draw_arrow(pen, View(WIDTH, HEIGHT, CAMERA), arrow(trace.position[tick], np.array(force)))
            words = f"push of {np.hypot(*force[:2]):.0f} N"
            pen.text((WIDTH - 12, 10), words, font=FONT, fill=PUSH, anchor="ra")
        pictures.append(np.asarray(picture))
    renderer.close()
    return pictures


def palette_of(pictures: list[Image.Image]) -> Image.Image:
    """One palette for all frames, which would flicker otherwise; the push, seldom seen, has its colour too."""
    samples = [np.asarray(picture) for picture in pictures[:: len(pictures) // 6]]
    swatch = np.full((HEIGHT // 4, samples[0].shape[1], 3), ImageColor.getrgb(PUSH), np.uint8)
    return Image.fromarray(np.vstack([*samples, swatch])).quantize(COLOURS)


def main() -> None:
    robot = describe_robot()
    config = EpisodeConfig(randomisation=Randomisation(enabled=False))
    trace = simulate(EpisodeSpec(TRAINED_STEPPING, 0, config=config), record_trace=True).trace
    assert trace is not None
    begin, *_, end = trace.time[gait_cycle(trace)]
    rate = FRAMES_PER_SECOND[".gif"]
    times = frame_times(begin, begin + CYCLES * (end - begin) - 1.0 / rate, rate)
    write_video(frames(trace, robot, times, "SARAH stepping in place"), HERE / "stepping.gif")
    for name, terrain in GROUNDS.items():
        draw_ground_picture(terrain, HERE / f"{name}.png")
    draw_push_recovery(HERE / "push_recovery.gif")
    draw_dimensions(robot, default_dimensions(), HERE / "dimensions.png")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        draw_robot(robot, folder / "robot")
        draw_state_machine(folder / "state_machine")
        draw_gait_cycle(trace, SteppingParameters(*TRAINED_STEPPING), folder / "gait_cycle")
        for picture in folder.glob("*.png"):
            shutil.copy(picture, HERE)


if __name__ == "__main__":
    main()
