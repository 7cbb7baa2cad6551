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
    :param solver_iterations: of the physics engine's constraint solver, per physics step
    :param control_rate: control ticks per second; the paper's pattern generator ran at 100
    :param added_plate_inertia: which PyBullet gives each foot plate about its hinge while its leg is not retracted, in
        kg m^2. It makes few solver iterations enough; 0 is the robot as it is
    """

    rate: int = 200
    solver_iterations: int = 32
    control_rate: int = 100
    added_plate_inertia: float = 0.008

    def __post_init__(self) -> None:
        """Refuse rates that do not divide into each other."""
        check_range("physics.control_rate", self.control_rate, SLOWEST_CONTROL_RATE, FASTEST_CONTROL_RATE, "Hz")
        check_range("physics.rate", self.rate, self.control_rate, FASTEST_PHYSICS_RATE, "Hz")
        if self.rate % self.control_rate:
            raise ConfigurationError(
                f"physics.rate must be a multiple of the control rate, {self.control_rate} Hz, not {self.rate!r}"
            )
        check_range("physics.solver_iterations", self.solver_iterations, 1, MOST_SOLVER_ITERATIONS)
        check_range("physics.added_plate_inertia", self.added_plate_inertia, 0.0, LARGEST_ADDED_INERTIA, "kg m^2")

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


PHYSICS = {"standard": Physics(), "reference": Physics(1000, 100, added_plate_inertia=0.0)}
"""Named settings: what training uses, and the finer one that published results are checked with."""
