"""How finely time is divided, and the named settings of it."""

from __future__ import annotations

from dataclasses import dataclass, replace

from sarah.errors import ConfigurationError, check_range

SLOWEST_CONTROL_RATE, FASTEST_CONTROL_RATE = 50, 1000
FASTEST_PHYSICS_RATE = 20_000
MOST_SOLVER_ITERATIONS = 10_000
LARGEST_ADDED_INERTIA = 1.0


@dataclass(frozen=True)
class Physics:
    """How finely time is divided.

    :param rate: physics steps per second, a multiple of the control rate; MuJoCo takes at least 300
    :param solver_iterations: iterations of the physics engine's constraint solver, per physics step
    :param control_rate: control ticks per second; the paper's pattern generator ran at 100
    """

    rate: int = 200
    solver_iterations: int = 32
    control_rate: int = 100

    def __post_init__(self) -> None:
        """Refuse rates that do not divide into each other."""
        check_range("physics.control_rate", self.control_rate, SLOWEST_CONTROL_RATE, FASTEST_CONTROL_RATE, "Hz")
        check_range("physics.rate", self.rate, self.control_rate, FASTEST_PHYSICS_RATE, "Hz")
        if self.rate % self.control_rate:
            raise ConfigurationError(
                f"physics.rate must be a multiple of the control rate, {self.control_rate} Hz, not {self.rate!r}"
            )
        check_range("physics.solver_iterations", self.solver_iterations, 1, MOST_SOLVER_ITERATIONS)

    def at_control_rate(self, control_rate: int) -> Physics:
        """The same physics for another control rate; its own rate is raised to the next multiple of that.

        :param control_rate: control ticks per second
        """
        multiple = -(-self.rate // control_rate)
        return replace(self, rate=multiple * control_rate, control_rate=control_rate)

    @property
    def control_dt(self) -> float:
        """Duration of a control tick, in s."""
        return 1.0 / self.control_rate


@dataclass(frozen=True)
class PyBulletPhysics(Physics):
    """How finely PyBullet divides time, and what makes few solver iterations enough there.

    :param added_plate_inertia: inertia that each foot plate gets about its hinge while its leg is not retracted, in
        kg m^2; 0 is the robot as it is
    """

    added_plate_inertia: float = 0.008

    def __post_init__(self) -> None:
        """Refuse what cannot be simulated."""
        super().__post_init__()
        check_range("physics.added_plate_inertia", self.added_plate_inertia, 0.0, LARGEST_ADDED_INERTIA, "kg m^2")


PHYSICS = {"standard": PyBulletPhysics(), "reference": PyBulletPhysics(1000, 100, added_plate_inertia=0.0)}
"""Named settings: what training uses, and the finer one that published results are checked with. Another engine than
PyBullet takes of them what it has."""


def physics_type(engine: str) -> type[Physics]:
    """The kind of settings that an engine takes.

    :param engine: ``"pybullet"`` or ``"mujoco"``
    """
    return PyBulletPhysics if engine == "pybullet" else Physics


def physics_for(engine: str, physics: Physics) -> Physics:
    """Settings as an engine takes them: those that only another engine knows are left out, or get their named values.

    :param engine: ``"pybullet"`` or ``"mujoco"``
    :param physics: settings of any engine
    """
    if type(physics) is physics_type(engine):
        return physics
    shared = Physics(physics.rate, physics.solver_iterations, physics.control_rate)
    if engine != "pybullet":
        return shared
    named = (setting for setting in PHYSICS.values() if physics_for("mujoco", setting) == shared)
    return next(named, PyBulletPhysics(shared.rate, shared.solver_iterations, shared.control_rate))
