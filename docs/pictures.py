"""Draws the pictures of README and docs: ``python docs/pictures.py`` writes them beside this file."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.episode import simulate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.pictures.dimension_figure import draw_dimensions
from sarah.pictures.gait_figure import draw_gait_cycle, gait_cycle
from sarah.pictures.robot_figure import draw_robot
from sarah.pictures.state_machine_figure import draw_state_machine
from sarah.pictures.video import FRAMES_PER_SECOND, frame_times, frames, write_video
from sarah.robot.description import describe_robot
from sarah.robot.dimensions import default_dimensions
from sarah.simulation.randomisation import Randomisation
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


def draw_ground_picture(terrain: Terrain, path: Path) -> None:
    """Draw the robot while it steps on some ground.

    :param terrain: the ground
    :param path: path of the picture
    """
    shipped = PARAMETER_SETS["balance"].spec
    config = BALANCE.config_of(shipped.config, terrain=terrain, time_limit=GROUND_SECONDS + 1.0, push=Push((0.0, 0.0)))
    spec = EpisodeSpec(shipped.parameters, 0, BALANCE, config)
    trace = simulate(spec, record_trace=True).trace
    assert trace is not None
    (picture,) = frames(trace, spec.robot, [GROUND_SECONDS], ground=spec.ground)
    picture.save(path)


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
