"""Draws the pictures of README and docs: ``python docs/pictures.py`` writes them beside this file."""

from __future__ import annotations

import shutil
import tempfile
from pathlib import Path

from sarah.control.pattern_generator import SteppingParameters
from sarah.episode.episode import simulate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks.balance import TRAINED_STEPPING
from sarah.pictures.gait_figure import draw_gait_cycle, gait_cycle
from sarah.pictures.robot_figure import draw_robot
from sarah.pictures.state_machine_figure import draw_state_machine
from sarah.pictures.video import FRAMES_PER_SECOND, frame_times, frames, write_video
from sarah.robot.description import describe_robot
from sarah.simulation.randomisation import Randomisation

HERE = Path(__file__).parent
CYCLES = 4
"""Number of gait cycles in the video, which so repeats without a jump."""


def main() -> None:
    robot = describe_robot()
    config = EpisodeConfig(randomisation=Randomisation(enabled=False))
    trace = simulate(EpisodeSpec(TRAINED_STEPPING, 0, config=config), record_trace=True).trace
    assert trace is not None
    begin, *_, end = trace.time[gait_cycle(trace)]
    rate = FRAMES_PER_SECOND[".gif"]
    times = frame_times(begin, begin + CYCLES * (end - begin) - 1.0 / rate, rate)
    write_video(frames(trace, robot, times, "SARAH stepping in place"), HERE / "stepping.gif")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        draw_robot(robot, folder / "robot")
        draw_state_machine(folder / "state_machine")
        draw_gait_cycle(trace, SteppingParameters(*TRAINED_STEPPING), folder / "gait_cycle")
        for picture in folder.glob("*.png"):
            shutil.copy(picture, HERE)


if __name__ == "__main__":
    main()
