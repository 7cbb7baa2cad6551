"""Parameters that the package ships, by name: something to look at without a training."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.from_mapping import from_mapping
from sarah.episode.shipped import shipped, shipped_parameters
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import STEPPING, task_named


@dataclass(frozen=True)
class ParameterSet:
    """Parameters with a name.

    :param spec: episode of these parameters, with seed 0
    :param origin: line that says where they come from
    """

    spec: EpisodeSpec
    origin: str


def _learned(name: str, content: dict[str, Any]) -> ParameterSet:
    """A set of the package's file."""
    task, origin = task_named(content["task"]), content["origin"]
    config = from_mapping(task.episode, content["settings"])
    spec = EpisodeSpec(shipped_parameters(name, task.parameters), 0, task, config)
    return ParameterSet(spec, f"{origin['command']}, commit {origin['commit']}, {origin['date']}")


PARAMETER_SETS = {
    "paper": ParameterSet(EpisodeSpec(PAPER_STEPPING, 0, STEPPING), "P1 to P3 of the paper, with P4 = P5 = 1"),
    **{name: _learned(name, content) for name, content in shipped().items()},
}
"""Shipped parameters, by the name that commands take."""
