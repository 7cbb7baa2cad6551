"""Resolution of the physics in time, and its named settings."""

from __future__ import annotations

import math
from dataclasses import astuple, dataclass, replace
from typing import Annotated, TypeVar

from sarah.errors import ConfigurationError, check_whole
from sarah.ranges import Within, check_ranges
from sarah.robot.scale import DIGITS, Scale, Sized

CONTROL_RATES = Within(50, 1000, "Hz")
CONTROL_STEP = 50
"""Control rates of robots of another size are multiples of this, in Hz."""
LITTLE_CONTROL_STEP = 0.3
"""Share of such a step that a robot of another size does without: one that is little smaller has the same rate."""
LITTLE_PAIR = 0.05
"""Share of a pair of physics steps in a control tick that a robot of another size does without. Steps come in pairs, so
that the control rate can be doubled."""

PhysicsType = TypeVar("PhysicsType", bound="Physics")


@dataclass(frozen=True)
class Physics:
    """Resolution of the physics in time.

    :param rate: physics steps per second, a multiple of the control rate; MuJoCo takes at least 500
    :param solver_iterations: iterations of the physics engine's constraint solver, per physics step
    :param control_rate: control ticks per second; the paper's pattern generator ran at 100
    """

    rate: Annotated[int, Within(50, 20_000, "Hz")] = 400
    solver_iterations: Annotated[int, Within(1, 10_000)] = 20
    control_rate: Annotated[int, CONTROL_RATES] = 100

    def __post_init__(self) -> None:
        """Refuse rates that do not divide into each other."""
        check_ranges("physics.", self)
        if self.rate % self.control_rate:
            raise ConfigurationError(
                f"physics.rate must be a multiple of the control rate, {self.control_rate} Hz, such as "
                f"{-(-self.rate // self.control_rate) * self.control_rate}, not {self.rate!r}"
            )

    def at_control_rate(self: PhysicsType, control_rate: int) -> PhysicsType:
        """Physics for another control rate; the physics rate is raised to the next multiple of it.

        :param control_rate: control ticks per second
        """
        check_whole("physics.control_rate", control_rate, *astuple(CONTROL_RATES))
        multiple = -(-self.rate // control_rate)
        return replace(self, rate=multiple * control_rate, control_rate=control_rate)

    def at_scale(self: PhysicsType, scale: Scale) -> PhysicsType:
        """Physics for a robot of another size: what is over sooner needs more steps and control ticks per second.

        :param scale: size of the robot as ratios to that of the robot which this physics is for
        """
        if scale.length == 1.0:
            return scale.scaled(self)
        faster = scale.factor("per second")
        control_steps = round(self.control_rate * faster / CONTROL_STEP, DIGITS)
        control_rate = CONTROL_STEP * max(1, math.ceil(control_steps - LITTLE_CONTROL_STEP))
        pairs = round(self.rate * faster / (2 * control_rate), DIGITS)
        rate = 2 * control_rate * max(1, math.ceil(pairs - LITTLE_PAIR))
        return replace(scale.scaled(self), rate=rate, control_rate=control_rate)

    @property
    def control_dt(self) -> float:
        """Duration of a control tick, in s."""
        return 1.0 / self.control_rate


@dataclass(frozen=True)
class PyBulletPhysics(Physics):
    """Resolution of PyBullet's physics in time, and an added inertia with which few solver iterations are enough.

    :param added_plate_inertia: inertia added to each foot plate about its hinge while it presses on its pad, in kg m^2;
        0 leaves the robot as it is
    """

    added_plate_inertia: Annotated[float, Sized(0.0, 100.0, "kg m^2")] = 0.003


PHYSICS = {"standard": PyBulletPhysics(), "reference": PyBulletPhysics(1000, 100, added_plate_inertia=0.0)}
"""Named settings: ``standard``, which trainings use, and the finer ``reference``, which checks results. MuJoCo
ignores the fields that it does not have."""


def named_physics(name: str, scale: Scale, control_rate: int) -> PyBulletPhysics:
    """Named settings for a robot of any size.

    :param name: name of the settings, one of :data:`PHYSICS`
    :param scale: size of the robot
    :param control_rate: control ticks per second
    """
    return PHYSICS[name].at_scale(scale).at_control_rate(control_rate)


def physics_for(engine: str, physics: Physics, scale: Scale) -> Physics:
    """Settings of any engine as another engine takes them; fields of PyBullet alone are dropped or get named values.

    :param engine: name of the engine that takes them, ``"pybullet"`` or ``"mujoco"``
    :param physics: settings of any engine
    :param scale: size of the robot
    """
    if type(physics) is (PyBulletPhysics if engine == "pybullet" else Physics):
        return physics
    rate, iterations, control_rate = physics.rate, physics.solver_iterations, physics.control_rate
    if engine != "pybullet":
        return Physics(rate, iterations, control_rate)
    named = [named_physics(name, scale, control_rate) for name in PHYSICS]
    same = (setting for setting in named if (setting.rate, setting.solver_iterations) == (rate, iterations))
    return next(same, replace(named[0], rate=rate, solver_iterations=iterations))
