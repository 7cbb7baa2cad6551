"""Parameters that the package ships, by name: something to look at without a training."""

from __future__ import annotations

from dataclasses import dataclass

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.from_mapping import from_mapping
from sarah.episode.shipped import FILE, shipped, shipped_parameters, shipped_value
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import STEPPING, task_named
from sarah.errors import ConfigurationError


@dataclass(frozen=True)
class ParameterSet:
    """Parameters with a name.

    :param spec: episode of these parameters, with seed 0
    :param origin: line that says where they come from
    """

    spec: EpisodeSpec
    origin: str


def learned_set(name: str) -> ParameterSet:
    """A set of the package's file.

    :param name: name of the set
    :raises ConfigurationError: naming the file and what is wrong in it
    """
    reference, settings = [shipped_value(name, key) for key in ("task", "settings")]
    command, commit, date = [shipped_value(name, "origin", key) for key in ("command", "commit", "date")]
    try:
        task = task_named(str(reference))
        config = from_mapping(task.episode, settings)
    except ConfigurationError as error:
        raise ConfigurationError(f"{FILE}: {name}: {error}") from error
    spec = EpisodeSpec(shipped_parameters(name, task.parameters), 0, task, config)
    return ParameterSet(spec, f"{command}, commit {commit}, {date}")


PARAMETER_SETS = {
    "paper": ParameterSet(EpisodeSpec(PAPER_STEPPING, 0, STEPPING), "P1 to P3 of the paper, with P4 = P5 = 1"),
    **{name: learned_set(name) for name in shipped()},
}
"""Shipped parameters, by the name that commands take."""
