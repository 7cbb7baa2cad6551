"""``sarah-train --offline``: learn from logs what robots feel and which parameters suit them, without simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import fmean
from typing import TYPE_CHECKING, Annotated

import tyro

from sarah.cli.next_steps import say_next, to_see
from sarah.cli.options import parse_options
from sarah.recognition.recognition import Kind

if TYPE_CHECKING:
    from sarah.recognition.logged import LoggedRobot
    from sarah.recognition.recognition import Recognition

COMMAND = "sarah-train"


@dataclass(frozen=True)
class OfflineOptions:
    """Learn from logs, without simulation, in seconds: which robots there are, and which parameters suit each.

    It writes a folder with recognition.json, which sarah-operate --learner recognise --from takes, and parameters.json:
    the one set that is best on average for all robots of the logs. Other commands show that set.

    :param offline: folders of sessions, MCAP files of sarah-operate --log, and CSV files with the columns of a
        session's windows.csv and, if they have them, robot and kind
    :param kind: ``nearest``: what is known of the kinds that are felt alike; ``classes``: a linear discriminant with a
        shrunk covariance tells kinds apart; ``network``: a small network does; ``model``: a Gaussian process of what is
        felt and of the parameters; ``naf``: NAF chooses sets, with the logs as replay; ``best``: one set for all
    :param out: folder to write, new or empty; by default a new one, runs/recognition/<kind>
    """

    offline: Annotated[tuple[Path, ...], tyro.conf.arg(metavar="LOG...")] = ()
    kind: Kind = "nearest"
    out: Annotated[Path | None, tyro.conf.arg(metavar="DIR")] = None


def train_offline(arguments: Sequence[str]) -> None:
    """Learn from logs, and say what they show.

    :param arguments: arguments of the command
    """
    options = parse_options(OfflineOptions, COMMAND, arguments, OfflineOptions())
    from sarah.recognition.folder import RecognitionFolder
    from sarah.recognition.learning import learn
    from sarah.recognition.logs import read_logs
    from sarah.recorded.folder import new_path

    robots = read_logs(options.offline)
    recognition = learn(robots, options.kind)
    folder = RecognitionFolder.create(options.out or new_path("recognition", options.kind), recognition)
    _say(robots, recognition)
    print(f"folder      {folder.path}")
    use = ("recognise a robot", ("sarah-operate", "--learner", "recognise", "--from", folder.path))
    say_next(use, to_see(folder.path))


def _say(robots: Sequence[LoggedRobot], recognition: Recognition) -> None:
    from sarah.recognition.learning import best_of_all, best_set, rewards_of

    used = [robot for robot in robots if robot.kind in recognition.kinds]
    windows = sum(len(robot.windows) for robot in used)
    print(f"learned     {recognition.kind} from {windows} windows of {len(used)} robots")
    reference = ",".join(f"{value:g}" for value in recognition.reference)
    for kind in dict.fromkeys(robot.kind for robot in robots if robot.kind not in recognition.kinds):
        print(f"left out    {kind}: it never ran the parameters that robots are recognised with, {reference}")
    one_for_all, rows = best_of_all(recognition), []
    for robot in used:
        rewards, own = rewards_of([robot]), best_set(robot, recognition.reference)
        seen = [
            f"{fmean(rewards[one]):.2f}" if one in rewards else "" for one in (recognition.reference, one_for_all, own)
        ]
        rows.append((robot.name, str(len(robot.windows)), str(len(rewards)), *seen))
    head = ("robot", "windows", "sets", "shipped", "one for all", "its best")
    width = max(len(row[0]) for row in (head, *rows))
    print("observed rewards:")
    for name, *cells in (head, *rows):
        print(f"  {name:{width}}" + "".join(f"{cell:>13}" for cell in cells))
