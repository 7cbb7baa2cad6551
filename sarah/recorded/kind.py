"""Kinds of what is recorded."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Kind:
    """A kind of what is recorded.

    :param name: word for it
    :param folder: words for its folder
    :param specification: name of the file that makes a folder one of this kind
    :param command: command that goes on with it by ``--resume``
    """

    name: str
    folder: str
    specification: str
    command: str

    def owns(self, path: Path) -> bool:
        """Whether a folder is one of this kind.

        :param path: path of the folder
        """
        return path.joinpath(self.specification).is_file()
