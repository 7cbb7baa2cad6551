"""The controller by itself on the simulated robot: it steps, takes new parameters, and notices when it falls."""

import math
from collections.abc import Callable

import pytest
from laboratory import need

from sarah.control.constants import ControllerConstants
from sarah.control.hip_law import BalanceParameters
from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.episode.episode import Episode, simulate
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import Push
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.robot.description import ACTUATED_JOINTS, describe_robot
from sarah.robot.reading import SensorReading
from sarah.simulation.build import simulator_of
from sarah.simulation.physics import PHYSICS
from sarah.simulation.randomisation import NOMINAL

STEPPING = (0.41, 0.52, 0.62, 1.17, 1.37)
V = BalanceParameters(1.0, 0.0, 1.0, 0.0)


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
@pytest.mark.parametrize("degrees", [0.0, 90.0, 180.0, 270.0, 45.0])
def test_a_robot_that_is_pushed_over_is_noticed_within_half_a_second_of_60_degrees_and_targets_stay(
    engine: str, degrees: float
) -> None:
    """Measured from eight directions with 150 to 600 N: 0.06 to 0.2 s."""
    need(engine)
    robot, direction = describe_robot(), math.radians(degrees)
    limits = [robot.limits[joint] for joint in ACTUATED_JOINTS]
    generator = PatternGenerator(SteppingParameters(*STEPPING), V, limits=limits)
    simulation = simulator_of(engine)(robot, PHYSICS["standard"], NOMINAL)
    tilts, targets, fallen = [], [], []
    for tick in range(500):
        generator.tick(simulation.read())
        simulation.set_targets(generator.targets)
        if 250 <= tick < 280:
            simulation.push((200.0 * math.cos(direction), 200.0 * math.sin(direction), 0.0))
        simulation.advance()
        tilts.append(math.degrees(math.acos(simulation.torso_state().axis[2])))
        targets.append(generator.targets)
        fallen.append(generator.has_fallen)
    simulation.close()
    down = next(tick for tick, tilt in enumerate(tilts) if tilt > 60.0)
    noticed = fallen.index(True)
    assert max(tilts[:250]) < 10.0 and 250 < noticed < down + 50
    assert len(set(targets[:noticed])) > 50 and len(set(targets[noticed:])) == 1


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
def test_no_push_that_the_robot_survives_is_taken_for_a_fall(engine: str) -> None:
    """Measured in 388 episodes that robots survived, 237 of them with pushes of 50 to 125 N and 246 with random P or V:
    the low-passed vertical acceleration stays above 8.1 m/s^2, and a fall is recognised below 5.
    """
    need(engine)
    survived = 0
    for seed in range(8):
        config = BalanceConfig(engine=engine, push=Push((100.0, 125.0)), time_limit=6.0, stepping=STEPPING)
        with Episode(config, seed, BALANCE) as episode:
            episode.stand()
            episode.run((V.V1, V.V2, V.V3, V.V4))
        survived += episode.termination == "time_limit"
        assert not episode.robot.generator.has_fallen or episode.termination != "time_limit"
    assert survived >= 5


@pytest.mark.parametrize("engine", ["pybullet", "mujoco"])
@pytest.mark.parametrize("v2", [1.0, -1.0])
def test_a_jump_of_v2_while_the_robot_steps_is_no_push(engine: str, v2: float) -> None:
    """At eight moments of the gait, with noise and constant errors; the robot steps on by its sensors."""
    need(engine)
    config = BalanceConfig(engine=engine, push=Push((0.0, 0.0)), time_limit=7.0, stepping=STEPPING)
    for seed in range(8):
        with Episode(config, seed, BALANCE) as episode:
            episode.stand()
            episode.start((1.0, 0.0, 1.0, 0.0))
            for _ in range(200 + 7 * seed):
                episode.tick()
            episode.robot.generator.set_parameters(balance=BalanceParameters(1.0, v2, 1.0, 0.0))
            while episode.termination is None:
                episode.tick()
        result = episode.result()
        assert result.survived and not episode.robot.generator.has_fallen
        assert result.steps_per_second > 2.0 and result.shifts_by_sensors > 0.8


def test_legs_that_spread_save_robots_that_a_push_to_the_side_tips_over() -> None:
    """Measured on these 24 pushes: 18 survivors, and 11 without the spread."""
    need("mujoco")

    def survivors(spread_gain: float) -> int:
        survived = 0
        for seed in range(24):
            push = Push(125.0, (180.0 * (seed % 2),) * 2, (2.0, 3.0))
            constants = ControllerConstants(spread_gain=spread_gain)
            config = BalanceConfig(engine="mujoco", controller=constants, push=push, time_limit=5.0, stepping=STEPPING)
            survived += simulate(EpisodeSpec((1.0, 0.0, 0.7, 0.0), seed, BALANCE, config)).survived
        return survived

    assert survivors(ControllerConstants().spread_gain) > survivors(0.0) + 3


@pytest.mark.parametrize("offsets", [(0.0, 0.0, 0.02, 0.02), (0.0, 0.0, -0.02, 0.02), (0.05, -0.05, 0.0, 0.0)])
def test_zeros_of_the_joints_may_be_as_far_off_as_the_page_says(offsets: tuple[float, ...]) -> None:
    """Flexion that reads 0.05 rad too much walks the robot out of its place within 12 s."""
    spec = PARAMETER_SETS["balance"].spec
    config = BALANCE.config_of(spec.config, engine="mujoco", push=Push((0.0, 0.0)), time_limit=13.0)
    terminations = {}
    for added in (offsets, (0.0, 0.0, 0.05, 0.05)):
        with Episode(config, 1000, BALANCE) as episode:
            read = episode.robot.simulation.read

            def askew(read: Callable[[], SensorReading] = read, added: tuple[float, ...] = added) -> SensorReading:
                seen = read()
                shifted = [joint + offset for joint, offset in zip(seen.joints, (*added, 0.0, 0.0), strict=True)]
                return seen._replace(joints=tuple(shifted))  # type: ignore[arg-type]  # there are six

            episode.robot.simulation.read = askew  # type: ignore[method-assign]
            episode.stand()
            terminations[added] = episode.run(spec.parameters).termination
    assert list(terminations.values()) == ["time_limit", "left_box"]
