"""Draws the picture of the README: ``python docs/readme_picture.py`` writes push_recovery.gif beside this file.

Two robots step in place and meet the same push: one with locked hips, one with what NAF learned in a Second Training.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import matplotlib
import numpy as np
from PIL import Image, ImageColor, ImageDraw, ImageFont

from sarah.episode.ending import TERMINATIONS
from sarah.episode.episode import simulate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import PUSH_SHOWN_SECONDS, Push
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.episode.trace import Trace
from sarah.pictures.colours import PUSH
from sarah.pictures.overlay import INK
from sarah.robot.description import ANKLE_JOINTS, describe_robot
from sarah.robot.reading import ACTUATED_JOINTS
from sarah.scenery.camera import Camera, View
from sarah.scenery.push_arrow import METRES_PER_NEWTON
from sarah.simulation.renderer import Renderer

OUT = Path(__file__).parent / "push_recovery.gif"
SHIPPED = PARAMETER_SETS["balance"].spec
LEARNED = SHIPPED.parameters
CAPTIONS = {(0.0, 0.0, 0.0, 0.0): "hips locked", LEARNED: "hips as NAF learned"}
SEED, NEWTONS = 76, 100.0
BEGIN, END = 1.0, 5.0
"""Of the picture, in s of simulated time: the push comes after some 0.4 s of stepping."""
FRAMES_PER_SECOND = 20
WIDTH, HEIGHT = 400, 380
"""Of each robot's half, in pixels."""
CAMERA = Camera(height=0.54, distance=2.15, yaw=170.0, pitch=-7.0)
COLOURS = 128
FONT = Path(matplotlib.get_data_path()) / "fonts" / "ttf" / "DejaVuSans-Bold.ttf"


def main() -> None:
    config = replace(SHIPPED.config, push=Push(newtons=NEWTONS), time_limit=10.0)
    halves = []
    for parameters, caption in CAPTIONS.items():
        result = simulate(EpisodeSpec(parameters, SEED, "balance", config), record_trace=True)
        assert result.survived is (parameters == LEARNED), "another seed shows the difference"
        halves.append(film(result, caption))
    pictures = [join(pair) for pair in zip(*halves, strict=True)]
    palette = palette_of(pictures)
    first, *others = (picture.quantize(palette=palette, dither=Image.Dither.NONE) for picture in pictures)
    first.save(OUT, save_all=True, append_images=others, duration=1000 // FRAMES_PER_SECOND, loop=0)
    print(f"{OUT}: {OUT.stat().st_size / 1e6:.2f} MB")


def film(result: EpisodeResult, caption: str) -> list[Image.Image]:
    """Draw one robot; an episode that has ended stays as it ended."""
    trace = result.trace
    assert trace is not None
    renderer = Renderer(describe_robot())
    view = View(WIDTH, HEIGHT, CAMERA)
    pictures = []
    for time in np.arange(BEGIN, END, 1.0 / FRAMES_PER_SECOND):
        tick = trace.tick_at(min(time, trace.time[-1]))
        joints = (*trace.joints[tick], *trace.ankles[tick])
        picture = Image.fromarray(
            renderer.draw(
                tuple(trace.position[tick]),
                tuple(trace.orientation[tick]),
                dict(zip(ACTUATED_JOINTS + ANKLE_JOINTS, joints, strict=True)),
                WIDTH,
                HEIGHT,
                CAMERA,
            )
        )
        ending = TERMINATIONS[result.termination] if time > trace.time[-1] else ""
        write(picture, view, trace, tick, time, f"{caption}\n{ending}")
        pictures.append(picture)
    renderer.close()
    return pictures


def write(picture: Image.Image, view: View, trace: Trace, tick: int, time: float, words: str) -> None:
    """Write over a half: whose it is and how its episode ended, and the push while it can be seen."""
    pen = ImageDraw.Draw(picture)
    pen.multiline_text((12, 10), words, font=ImageFont.truetype(FONT, 17), fill=INK)
    pushed = np.flatnonzero(np.linalg.norm(trace.push, axis=1))[0]
    if 0.0 <= time - trace.time[pushed] < PUSH_SHOWN_SECONDS:
        draw_push(pen, view, trace.position[tick], trace.push[pushed])


def draw_push(pen: ImageDraw.ImageDraw, view: View, head: np.ndarray, force: np.ndarray) -> None:
    """An arrow that ends at the torso's centre."""
    tip, tail = view.pixels(np.array((head, head - METRES_PER_NEWTON * force)))
    along = (tip - tail) / max(1.0, float(np.hypot(*(tip - tail))))
    across = np.array((-along[1], along[0]))
    neck = tip - 16 * along
    pen.line((*tail, *neck), fill=PUSH, width=6)
    pen.polygon([tuple(tip), tuple(neck + 9 * across), tuple(neck - 9 * across)], fill=PUSH)
    font = ImageFont.truetype(FONT, 17)
    pen.text((WIDTH - 12, 10), f"push of {np.hypot(*force[:2]):.0f} N", font=font, fill=PUSH, anchor="ra")


def join(halves: tuple[Image.Image, ...]) -> Image.Image:
    """Both robots beside each other."""
    picture = Image.new("RGB", (len(halves) * WIDTH + 2, HEIGHT), "#C8CED6")
    for index, half in enumerate(halves):
        picture.paste(half, (index * (WIDTH + 2), 0))
    return picture


def palette_of(pictures: list[Image.Image]) -> Image.Image:
    """One palette for all frames, which would flicker otherwise; the push, seldom seen, has its colour too."""
    samples = [np.asarray(picture) for picture in pictures[:: len(pictures) // 6]]
    swatch = np.full((HEIGHT // 4, samples[0].shape[1], 3), ImageColor.getrgb(PUSH), np.uint8)
    return Image.fromarray(np.vstack([*samples, swatch])).quantize(COLOURS)


if __name__ == "__main__":
    main()
