"""The folder of what logs taught: only this module knows its layout.

recognition.json               the recognition, in plain numbers
parameters.json                the one set that is best for all robots of the logs, which other commands show
command.txt  versions.txt      the command and the versions that made them
"""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

from sarah.episode.push import PushedConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE
from sarah.files import replace_text
from sarah.operation.settings import BOX, controller_parameters
from sarah.recognition.learning import best_of_all
from sarah.recognition.recognition import Recognition, read_recognition
from sarah.recorded.folder import Folder
from sarah.runs.kinds import RECOGNITION
from sarah.runs.run_episodes import RunEpisode
from sarah.runs.run_folder import read_parameters

ONE_FOR_ALL = "one set that is best on average for all robots of the logs"
"""What parameters.json is, in words."""


class RecognitionFolder(Folder):
    """The files of a recognition.

    :param path: path of the folder
    """

    def __init__(self, path: Path) -> None:
        super().__init__(path, RECOGNITION)

    @classmethod
    def create(cls, path: Path, recognition: Recognition) -> RecognitionFolder:
        """Make a new folder, and write all of it.

        :param path: path of the folder, which must be new or empty
        :param recognition: what logs teach
        :raises RunFolderError: if the folder is not empty or cannot be written
        """
        folder = cls(path)
        content = {
            "parameters": dict(zip(BOX.names, best_of_all(recognition), strict=True)),
            "controller": asdict(recognition.conditions.controller),
            "control_rate": recognition.conditions.control_rate,
        }

        def write() -> None:
            replace_text(folder.result_path, json.dumps(content, indent=2) + "\n")
            replace_text(folder.specification_path, recognition.text())

        folder.begin(write)
        return folder

    @classmethod
    def open(cls, path: Path) -> RecognitionFolder:
        """Open a folder.

        :param path: path of the folder
        :raises RunFolderError: if it is not one
        """
        folder = cls(path)
        folder.check(finished=True)
        return folder

    def recognition(self) -> Recognition:
        """Read the recognition.

        :raises ConfigurationError: naming what is wrong in it
        """
        return read_recognition(self.specification_path)

    def best(self) -> RunEpisode:
        """Episode of the one set that is best for all robots of the logs, on the robot as simulated."""
        stepping, balance = controller_parameters(read_parameters(self.result_path, BOX))
        robot = PushedConfig(controller=self.recognition().conditions.controller)
        config = BALANCE.config_of(robot, stepping=tuple(vars(stepping).values()))
        spec = EpisodeSpec(tuple(vars(balance).values()), 0, BALANCE, config)
        return RunEpisode("learned", ONE_FOR_ALL, spec)
