"""``sarah-describe``: a robot as a drawing, as numbers, and as a URDF."""

from __future__ import annotations

import dataclasses
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.episode_options import (
    EpisodeOptions,
    given_dimensions,
    given_options,
    parse_episode_options,
)
from sarah.cli.next_steps import passed_on, say_next
from sarah.cli.options import as_command, named_task
from sarah.cli.subjects import episode_of
from sarah.episode.settings import EpisodeConfig
from sarah.episode.tasks import STEPPING
from sarah.errors import ConfigurationError
from sarah.runs.config import TrainingConfig
from sarah.runs.config_files import read_config

COMMAND = "sarah-describe"
NAME = "sarah_robot"
"""Name of the files, without suffix."""


@dataclass(frozen=True)
class DescribeOptions(EpisodeOptions):
    """Show a robot: the default one, that of a training, or one of your dimensions.

    It draws ``sarah_robot.png``, from the front and from the side, with an arrow for each dimension; changed dimensions
    are bold. It writes ``sarah_robot.urdf``, which other programs can load without further files, and prints masses,
    centre of mass, inertias, limits and efforts. Nothing is simulated.

    Give your dimensions as pairs of name and value in SI units: --episode.dimensions thigh_length 0.2 torso_mass 5

    :param subject: robot to show: that of a run folder, of numbers separated by commas, or of shipped parameters;
        without it, the default robot
    :param config: YAML file of settings whose robot to show, as sarah-train takes it
    :param out: folder for drawing and URDF
    """

    subject: Annotated[
        str | None, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]", help_behavior_hint="(optional)")
    ] = None
    config: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    out: Annotated[Path, tyro.conf.arg(metavar="DIR", help_behavior_hint="(default: the current folder)")] = Path(".")


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = sys.argv[1:]
    given = given_options(arguments, "config")

    def settings(own: EpisodeConfig, _: str | None) -> EpisodeConfig:
        if "config" not in given:
            return own
        return read_config(TrainingConfig, Path(given["config"]), dimensions=given_dimensions(arguments)).episode

    options = parse_episode_options(COMMAND, arguments, DescribeOptions(), adapted=settings)
    if options.config is not None and options.subject is not None:
        raise ConfigurationError("give --config or a subject, not both")
    task = named_task(options.task)
    if options.subject is not None:
        task = episode_of(options.subject, None, task).spec.task
    from sarah.cli.describe_text import lines_of
    from sarah.files import check_file, make_folder, replace_text
    from sarah.pictures.dimension_figure import draw_dimensions
    from sarah.robot.description import describe_robot
    from sarah.robot.dimensions import all_dimensions

    config = options.episode
    robot = describe_robot(config.dimensions)
    make_folder(options.out)
    picture, urdf = options.out / f"{NAME}.png", options.out / f"{NAME}.urdf"
    for file in (picture, urdf):
        check_file(file)
    print("\n".join(lines_of(config, dataclasses.replace((task or STEPPING).episode, engine=config.engine))))
    replace_text(urdf, robot.urdf)
    draw_dimensions(robot, all_dimensions(config.dimensions), picture)
    print(picture)
    print(urdf)
    if options.subject is None:
        say_next(("train it", ("sarah-train", *passed_on(arguments, "", "out"))))
