"""A session: a robot in operation whose parameters a learner renews. Its specification determines all its windows."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

from sarah.episode.from_mapping import convert_fields
from sarah.errors import ConfigurationError, check_whole, unknown_name
from sarah.operation.settings import BOX, SHIPPED, OperationConfig, Parameters

LARGEST_SEED = 2**31 - 1
LEARNERS = ("none", "careful", "naf", "cma-es", "random", "recognise")
"""Names of the learners."""
FORMER_LEARNERS = {"gp": "careful"}
"""Names of learners by their former ones, which are read for one release more."""


@dataclass(frozen=True)
class SessionSpec:
    """The specification of a session: everything that its result depends on.

    :param parameters: P1 to P5 and V1 to V4 that the robot begins with
    :param learner: name of the learner, one of :data:`LEARNERS`
    :param seed: seed of robot, world, noise, pushes and learner; a whole number, not negative
    :param config: settings of the operation
    :param recognition: identity of the recognition of learner ``recognise``; empty for the one that the package ships
    :raises ConfigurationError: naming what is not allowed
    """

    parameters: Parameters = SHIPPED
    learner: str = "careful"
    seed: int = 0
    config: OperationConfig = field(default_factory=OperationConfig)
    recognition: str = ""

    def __post_init__(self) -> None:
        """Convert values to their types, and refuse invalid specifications."""
        convert_fields(self)
        BOX.checked(self.parameters)
        object.__setattr__(self, "learner", FORMER_LEARNERS.get(self.learner, self.learner))
        if self.learner not in LEARNERS:
            raise ConfigurationError(unknown_name("learner", str(self.learner), LEARNERS))
        if self.recognition and self.learner != "recognise":
            raise ConfigurationError(f"recognition is for learner recognise, not {self.learner}")
        object.__setattr__(self, "seed", check_whole("seed", self.seed, 0, LARGEST_SEED))

    def extended_to(self, minutes: float) -> SessionSpec:
        """The session with a longer duration: it goes on from where it ended.

        :param minutes: the longer duration, what is over included, in min
        """
        return replace(self, config=self.config.extended_to(minutes))

    def frozen(self) -> SessionSpec:
        """The same robot in the same world, with the parameters of the beginning all along."""
        return replace(self, learner="none", recognition="")
