"""The controller by itself on the simulated robot: it steps, takes new parameters, and notices when it falls."""

import math
from typing import Any

import pytest
from laboratory import need

from sarah import PHYSICS, BalanceParameters, ControllerConstants, EpisodeConfig, EpisodeSpec, SensorReading, simulate
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import PatternGenerator, SteppingParameters
from sarah.episode.episode import Episode
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.push import NO_PUSH, Push
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.robot.description import ACTUATED_JOINTS, describe_robot
from sarah.simulation.build import simulator_of
from sarah.simulation.randomisation import NOMINAL

STEPPING = (0.41, 0.52, 0.62, 1.17, 1.37)
V = (1.0, 0.0, 1.0, 0.0)


@pytest.mark.parametrize("degrees", [0.0, 90.0])
def test_who_is_pushed_over_is_noticed_half_a_second_later(engine: Any, degrees: float) -> None:
    robot, direction = describe_robot(), math.radians(degrees)
    limits = [robot.limits[joint] for joint in ACTUATED_JOINTS]
    generator = PatternGenerator(SteppingParameters(*STEPPING), BalanceParameters(*V), limits=limits)
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


def test_no_push_that_the_robot_survives_is_taken_for_a_fall(engine: Any) -> None:
    survived = 0
    for seed in range(3):
        config = BalanceConfig(engine=engine, push=Push((100.0, 125.0)), time_limit=5.0, stepping=STEPPING)
        with Episode(config, seed, BALANCE) as episode:
            episode.stand()
            survived += episode.run(V).survived
        assert not episode.robot.generator.has_fallen or episode.termination != "time_limit"
    assert survived >= 2


@pytest.mark.parametrize("v2", [1.0, -1.0])
def test_a_jump_of_v2_while_the_robot_steps_is_no_push(engine: Any, v2: float) -> None:
    config = BalanceConfig(engine=engine, push=NO_PUSH, time_limit=5.0, stepping=STEPPING)
    for seed in (2, 5):  # two moments of the gait
        with Episode(config, seed, BALANCE) as episode:
            episode.stand()
            episode.start(V)
            for _ in range(100 + 7 * seed):
                episode.tick()
            episode.robot.generator.set_parameters(balance=BalanceParameters(1.0, v2, 1.0, 0.0))
            while episode.termination is None:
                episode.tick()
        result = episode.result()
        assert result.survived and not episode.robot.generator.has_fallen
        assert result.steps_per_second > 2.0 and result.shifts_by_sensors > 0.8


def test_legs_that_spread_save_robots_that_tip_over_to_the_side() -> None:
    need("mujoco")

    def survivors(spread_gain: float) -> int:
        survived = 0
        for seed in range(12):
            push = Push(125.0, (180.0 * (seed % 2),) * 2, (2.0, 3.0))
            constants = ControllerConstants(spread_gain=spread_gain)
            config = BalanceConfig(engine="mujoco", controller=constants, push=push, time_limit=4.0, stepping=STEPPING)
            survived += simulate(EpisodeSpec((1.0, 0.0, 0.7, 0.0), seed, BALANCE, config)).survived
        return survived

    assert survivors(ControllerConstants().spread_gain) > survivors(0.0) + 1


KEPT = {(0.0, 0.0, -0.02, 0.02): "time_limit", (0.05, -0.05, 0.0, 0.0): "time_limit"}
LEFT = {(0.0, 0.0, 0.05, 0.05): "left_box"}  # walks out of its place within 12 s


@pytest.mark.parametrize(("offsets", "termination"), (KEPT | LEFT).items())
def test_zeros_of_the_joints_may_be_as_far_off_as_the_page_says(offsets: tuple[float, ...], termination: str) -> None:
    spec = PARAMETER_SETS["balance"].spec
    config = BALANCE.config_of(spec.config, engine="mujoco", push=NO_PUSH, time_limit=13.0)
    with Episode(config, 1000, BALANCE) as episode:
        read = episode.robot.simulation.read

        def askew() -> SensorReading:
            seen = read()
            shifted = [joint + offset for joint, offset in zip(seen.joints, (*offsets, 0.0, 0.0), strict=True)]
            return SensorReading._make((*seen[:-1], tuple(shifted)))

        episode.robot.simulation.read = askew  # type: ignore[method-assign]
        episode.stand()
        assert episode.run(spec.parameters).termination == termination


def test_short_time_outs_end_phases_before_the_sensors_can() -> None:
    def stepping(**constants: float) -> Any:
        config = EpisodeConfig(time_limit=3.0, controller=ControllerConstants(**constants))
        return simulate(EpisodeSpec(PAPER_STEPPING, 0, config=config))

    standard, hurried = stepping(), stepping(time_out_seconds=0.03)  # in 0.05 s MuJoCo's legs end most shifts
    assert standard.shifts_by_sensors > 0.9 and standard.lifts_by_sensors > 0.9
    assert hurried.shifts_by_sensors < 0.1 and hurried.score < standard.score
