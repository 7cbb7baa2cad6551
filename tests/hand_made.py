"""Hand-made readings, and pattern generators that have stood."""

import math

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, Phase, SteppingParameters
from sarah.robot.reading import SensorReading

DT = 0.01
LOADED, UNLOADED = 75.0, 0.0
BALANCE = BalanceParameters(1.0, 0.0, 0.5, 0.0)


def reading(lateral: float = 0.0, rate: float = 0.0, left: float = LOADED, right: float = LOADED) -> SensorReading:
    """A reading with a lateral acceleration, a rate about y, and a load on each foot."""
    pads = (left / 2, left / 2, right / 2, right / 2)
    return SensorReading((lateral, 0.0, 9.81), (0.0, rate, 0.0), pads, (0.0,) * 6)


def started(
    parameters: tuple[float, ...] = PAPER_STEPPING, constants: ControllerConstants = STANDARD_CONSTANTS
) -> PatternGenerator:
    """A pattern generator that has stood level, and has just entered its first SHIFT."""
    return stood(PatternGenerator(SteppingParameters(*parameters), dt=DT, constants=constants))


def stood(generator: PatternGenerator, steady: SensorReading | None = None) -> PatternGenerator:
    """The same pattern generator, after it has stood."""
    while generator.phase is Phase.STAND:
        generator.tick(steady or reading())
    assert generator.phase is Phase.SHIFT
    return generator


def rocking(tick: int, dt: float = DT) -> SensorReading:
    """A reading of a robot that rocks from foot to foot at 1.5 Hz, and falls a little forward and backward."""
    phase = 2.0 * math.pi * 1.5 * tick * dt
    lateral, rate = -3.0 * math.sin(phase), 0.5 * math.cos(phase)
    left, right = (LOADED, UNLOADED) if lateral > 0.0 else (UNLOADED, LOADED)
    at_the_feet = reading(lateral, rate, 2 * left, 2 * right)
    return at_the_feet._replace(
        angular_rate=(0.2 * math.sin(phase / 2.0), rate, 0.0),
        joints=(0.0, 0.0, 0.02 * math.sin(phase), -0.02 * math.sin(phase), 0.0, 0.0),
    )


def heard(tick: int, still: bool = False) -> SensorReading:
    """A reading of a robot that stands for a second and then rocks, or stands still; no two are the same."""
    seen = reading() if still or tick < 100 else rocking(tick - 100)
    noise = 0.001 * (tick % 7)
    acceleration = (seen.acceleration[0] + noise, noise, seen.acceleration[2] + noise)
    return seen._replace(acceleration=acceleration, angular_rate=(noise, seen.angular_rate[1] + noise, noise))


# Over the right leg the body leans right: lateral acceleration negative, rate about y positive.
OVER_RIGHT = reading(lateral=-3.0, rate=0.3, left=UNLOADED, right=2 * LOADED)
ROCKING_BACK = reading(rate=-0.6, left=UNLOADED, right=2 * LOADED)
