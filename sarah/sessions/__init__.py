"""Sessions: a robot in operation whose parameters a learner renews, from what the robot itself feels.

It may import all but reports, the viewer and the commands.
"""

from __future__ import annotations

from pathlib import Path

SPECIFICATION = "session.yaml"
"""Name of the file that makes a folder a session's."""


def is_session(path: Path) -> bool:
    """Whether a folder is that of a session.

    :param path: path of the folder
    """
    return path.joinpath(SPECIFICATION).is_file()
