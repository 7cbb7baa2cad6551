"""One episode: how it ends, what it returns, and that it repeats."""

import dataclasses
import json
import subprocess
import sys

import numpy as np
import pytest

import sarah
from sarah.control.parameters import PAPER_STEPPING
from sarah.control.pattern_generator import STAND_SECONDS
from sarah.episode.ending import TERMINATIONS
from sarah.episode.episode import Episode, simulate
from sarah.episode.evaluation import Evaluation
from sarah.episode.push import Push, draw_push
from sarah.episode.result import EpisodeResult
from sarah.episode.reward import highest_return, reward_rate
from sarah.episode.settings import EpisodeConfig
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, BalanceConfig
from sarah.errors import ConfigurationError
from sarah.robot.description import describe_robot
from sarah.robot.reading import SensorReading
from sarah.simulation.physics import PHYSICS, Physics
from sarah.simulation.randomisation import Randomisation, draw_conditions
from sarah.simulation.simulator import TorsoState

CONTROL_DT = PHYSICS["standard"].control_dt
SHORT = EpisodeConfig(time_limit=6.0)


@pytest.fixture(scope="module")
def paper_episode() -> EpisodeResult:
    return simulate(EpisodeSpec(PAPER_STEPPING, seed=0), record_trace=True)


def test_papers_parameters_step_in_place_for_30_seconds(paper_episode: EpisodeResult) -> None:
    result = paper_episode
    assert result.termination == "time_limit" and result.survived
    assert result.duration == 30.0
    assert result.score > 0.78
    assert 2.3 < result.steps_per_second < 3.5
    assert result.drift < 0.06
    assert result.sole_clearance > 0.010
    assert result.shifts_by_sensors > 0.9 and result.lifts_by_sensors > 0.9


def test_return_is_equation_2_integrated_over_the_trace(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    start = trace.position[0]
    moved = trace.position - [start[0], start[1], 0.0]
    rewards = [reward_rate(*position, f) for position, f in zip(moved, trace.steps_per_second, strict=True)]
    # The trace holds the state before each tick and the reward the one after it, hence the tolerance.
    assert sum(rewards) * CONTROL_DT == pytest.approx(paper_episode.episode_return, rel=0.01)
    ceiling = highest_return(describe_robot().standing_height, 29.0)
    assert paper_episode.score == pytest.approx(paper_episode.episode_return / ceiling)


def test_trace_has_a_row_for_every_tick(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    assert len(trace) == 2900 and {len(values) for values in vars(trace).values()} == {2900}
    assert np.allclose(np.diff(trace.time), CONTROL_DT)
    assert set(trace.phase) == {"shift", "lift", "land"}
    assert trace.joints.shape == (2900, 6) and trace.ankles.shape == (2900, 4)
    assert not trace.push.any()


def test_trace_finds_the_tick_of_a_time(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    assert [trace.tick_at(time) for time in (0.0, 1.0, 1.013, 2.0, 99.0)] == [0, 0, 1, 100, 2899]
    assert all(trace.tick_at(time) == tick for tick, time in enumerate(trace.time))


def test_trace_follows_the_score(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    assert trace.score[0] == 0.0 and (np.diff(trace.score) >= 0.0).all()
    assert trace.score[-1] == pytest.approx(paper_episode.score, rel=0.001)


def test_trace_shows_the_push() -> None:
    push = Push(newtons=(60.0, 60.0), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0), duration=0.15)
    spec = EpisodeSpec((0.0,) * 4, 0, "balance", dataclasses.replace(SHORT, push=push))
    trace = simulate(spec, record_trace=True).trace
    assert trace is not None
    assert trace.time[trace.push.any(axis=1)] == pytest.approx(np.arange(2.0, 2.145, CONTROL_DT))
    assert trace.push[trace.tick_at(2.1)] == pytest.approx([0.0, 60.0, 0.0])


def test_trace_does_not_change_the_result(paper_episode: EpisodeResult) -> None:
    assert simulate(EpisodeSpec(PAPER_STEPPING, seed=0)) == paper_episode


def test_steps_of_the_trace_alternate_between_the_feet(paper_episode: EpisodeResult) -> None:
    trace = paper_episode.trace
    assert trace is not None
    swaps = np.flatnonzero(np.diff(trace.stance))
    assert len(swaps) >= paper_episode.steps
    assert np.median(np.diff(swaps)) * CONTROL_DT == pytest.approx(1 / paper_episode.steps_per_second, rel=0.1)


def test_what_a_process_simulated_before_or_meanwhile_changes_nothing() -> None:
    spec = EpisodeSpec(PAPER_STEPPING, seed=4, config=SHORT)
    expected = simulate(spec)
    longer = dataclasses.replace(SHORT, physics=Physics(1000, 10), dimensions={"thigh_length": 0.4})
    simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), seed=5, task="balance", config=longer))
    episode = Episode(SHORT, seed=4)
    try:
        episode.stand()
        assert simulate(spec) == expected
        assert episode.run(PAPER_STEPPING) == expected
    finally:
        episode.close()


@pytest.mark.parametrize(
    ("task", "parameters"), [("stepping", (0.4, 1.3, 0.1, 1.0, 1.0)), ("balance", (1.0, 0.1, 0.5, -0.2))]
)
def test_same_spec_gives_identical_results_in_two_fresh_processes(task: str, parameters: tuple[float, ...]) -> None:
    program = (
        "import dataclasses, json, sarah; "
        "config = sarah.EpisodeConfig(time_limit=6.0); "
        f"result = sarah.simulate(sarah.EpisodeSpec({parameters}, 7, {task!r}, config)); "
        "print(json.dumps(dataclasses.asdict(result)))"
    )
    runs = [subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout for _ in range(2)]
    assert runs[0] == runs[1]
    assert json.loads(runs[0])["steps"] > 0


def test_seeds_differ_and_the_order_of_episodes_does_not_matter() -> None:
    specs = [EpisodeSpec(PAPER_STEPPING, seed, config=SHORT) for seed in (3, 4)]
    forward = [simulate(spec) for spec in specs]
    backward = [simulate(spec) for spec in reversed(specs)]
    assert forward == backward[::-1]
    assert forward[0] != forward[1]


def test_everything_the_seed_draws_is_within_its_range() -> None:
    ranges = Randomisation()
    for seed in range(200):
        drawn = draw_conditions(ranges, seed)
        assert 0.7 <= drawn.friction <= 1.0
        assert 40.0 <= drawn.actuator_bandwidth <= 50.0
        assert 20.0 <= drawn.pad_threshold <= 40.0
        assert all(0.95 <= factor <= 1.05 for factor in drawn.mass_factors.values())
        assert len(set(drawn.mass_factors.values())) == len(drawn.mass_factors)


def test_changing_one_range_leaves_the_other_draws_alone() -> None:
    drawn = draw_conditions(Randomisation(), 5)
    other = draw_conditions(Randomisation(friction=(0.2, 0.3)), 5)
    assert 0.2 <= other.friction <= 0.3
    assert dataclasses.replace(other, friction=drawn.friction) == drawn


def test_randomisation_off_leaves_only_the_start_velocity() -> None:
    first, second = (draw_conditions(Randomisation(enabled=False), seed) for seed in (1, 2))
    assert first.start_velocity != second.start_velocity
    assert dataclasses.replace(first, start_velocity=second.start_velocity) == second
    assert set(first.mass_factors.values()) == {1.0} and first.acceleration_noise == 0.0 and first.delay_ticks == 0


def test_robot_that_does_not_step_is_stopped_after_5_seconds() -> None:
    """With conditions that no rocking meets and the slowest time-outs it makes no two steps in time."""
    result = simulate(EpisodeSpec((2.0, 2.0, 2.0, 2.0, 2.0), seed=0))
    assert result.termination == "no_oscillation"
    assert result.duration == 5.0
    assert result.score < 0.01


@pytest.mark.parametrize(
    "parameters",
    [
        (0.1, 2.0, 2.0, 0.0, 0.0),  # a P3 that no rate reaches leaves every SHIFT to its time-out
        (1.3, 1.0, 1.0, 0.0, 0.0),  # and a high P1 every LIFT
        (1.5, 0.5, 0.1, 0.0, 0.0),
    ],
)
def test_stepping_by_the_fastest_time_outs_is_told_apart_and_does_not_pay(parameters: tuple[float, ...]) -> None:
    result = simulate(EpisodeSpec(parameters, seed=0))
    assert result.steps > 0
    assert min(result.shifts_by_sensors, result.lifts_by_sensors) < 0.5
    assert result.score < 0.2


@pytest.mark.parametrize(
    ("state", "steps", "time", "expected"),
    [
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, None),
        (TorsoState((0.251, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, "left_box"),
        (TorsoState((0.0, -0.251, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, "left_box"),
        (TorsoState((0.0, 0.0, 0.58), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, "left_box"),
        (TorsoState((0.0, 0.0, 0.84), (0.4, 0, 0, 0.917), (0, 0, 0), (0, 0, 0)), 9, 10.0, "fell"),  # 47 degrees
        (TorsoState((0.0, 0.0, 0.84), (0.37, 0, 0, 0.929), (0, 0, 0), (0, 0, 0)), 9, 10.0, None),  # 43 degrees
        (TorsoState((float("nan"), 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 10.0, "diverged"),
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, float("inf")), (0, 0, 0)), 9, 10.0, "diverged"),
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 1, 4.99, None),
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 1, 5.0, "no_oscillation"),
        (TorsoState((0.0, 0.0, 0.84), (0, 0, 0, 1), (0, 0, 0), (0, 0, 0)), 9, 30.0, "time_limit"),
    ],
)
def test_stop_criteria(state: TorsoState, steps: int, time: float, expected: str | None) -> None:
    episode = Episode(EpisodeConfig(), seed=0)
    assert episode._termination(state, steps, time) == expected
    assert expected is None or expected in TERMINATIONS
    episode.close()


def test_diverging_physics_ends_with_a_finite_return(monkeypatch: pytest.MonkeyPatch) -> None:
    episode = Episode(SHORT, seed=0)
    episode.stand()
    healthy = episode.simulation.torso_state
    calls = 0

    def diverging() -> TorsoState:
        nonlocal calls
        calls += 1
        state = healthy()
        return state._replace(position=(float("nan"),) * 3) if calls > 100 else state

    monkeypatch.setattr(episode.simulation, "torso_state", diverging)
    result = episode.run(PAPER_STEPPING)
    episode.close()
    assert result.termination == "diverged" and not result.survived
    assert np.isfinite([result.score, result.episode_return, *result.final_position]).all()


def test_printed_reward_form_changes_the_return() -> None:
    printed = dataclasses.replace(SHORT, reward_form="printed")
    returns = [simulate(EpisodeSpec(PAPER_STEPPING, 0, config=config)).episode_return for config in (SHORT, printed)]
    assert returns[0] != returns[1]


def test_longer_feet_are_another_robot() -> None:
    longer = dataclasses.replace(SHORT, dimensions={"forefoot_contact": 0.15, "hindfoot_contact": 0.15})
    assert simulate(EpisodeSpec(PAPER_STEPPING, 0, config=SHORT)) != simulate(
        EpisodeSpec(PAPER_STEPPING, 0, config=longer)
    )


def test_spec_refuses_unknown_tasks_and_bad_parameters() -> None:
    with pytest.raises(ConfigurationError, match="unknown task 'steping', did you mean 'stepping'"):
        EpisodeSpec(PAPER_STEPPING, 0, task="steping")
    with pytest.raises(ConfigurationError, match="P1 must be between"):
        EpisodeSpec((3.0, 1.3, 0.1, 1.0, 1.0), 0)


@pytest.mark.parametrize("seed", [None, -1, 1.5, True])
def test_spec_refuses_seeds_that_would_not_repeat(seed: object) -> None:
    with pytest.raises(ConfigurationError, match="seed must be a whole number from 0"):
        EpisodeSpec(PAPER_STEPPING, seed)  # type: ignore[arg-type]


class NoPhysics:
    """A simulator in which nothing ever moves."""

    def __init__(self, *_: object) -> None:
        self.time = 0.0
        self.closed = False
        self.targets: list[tuple[float, ...]] = []

    def set_targets(self, targets: tuple[float, ...]) -> None:
        self.targets.append(targets)

    def push(self, force: tuple[float, float, float]) -> None:
        raise AssertionError("nobody pushes in the first training")

    def advance(self) -> None:
        self.time += CONTROL_DT

    def read(self) -> SensorReading:
        return SensorReading((0.0, 0.0, 9.81), (0.0, 0.0, 0.0), (75.0,) * 4, (0.0,) * 6)

    def torso_state(self) -> TorsoState:
        return TorsoState((0.0, 0.0, 0.84), (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0))

    def actuator_motion(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        return (0.0,) * 6, (0.0,) * 6

    def joint_positions(self, names: tuple[str, ...]) -> tuple[float, ...]:
        return (0.0,) * len(names)

    def sole_height(self, side: str) -> float:
        return 0.0

    def close(self) -> None:
        self.closed = True


def test_episode_runs_on_any_simulator() -> None:
    """Where nothing moves, the feet never leave the floor: time-outs only, no step, no oscillation."""
    perfect = EpisodeConfig(randomisation=Randomisation(enabled=False))
    episode = Episode(perfect, seed=0, build=NoPhysics)
    reading = episode.stand()
    assert episode.simulation.time == pytest.approx(1.0) and reading.pressures == (75.0,) * 4
    result = episode.run(PAPER_STEPPING)
    assert result.termination == "no_oscillation" and result.duration == 5.0
    assert result.steps == 0 and result.shifts_by_sensors == 0.0
    assert result.final_position == (0.0, 0.0, 0.84)


def test_package_offers_the_simulation_by_name() -> None:
    assert sarah.simulate is simulate and sarah.EpisodeSpec is EpisodeSpec
    assert sarah.Physics is Physics
    with pytest.raises(AttributeError, match="simulat"):
        sarah.simulat  # noqa: B018


def test_standing_lasts_one_second() -> None:
    episode = Episode(SHORT, seed=0)
    episode.stand()
    assert episode.simulation.time == pytest.approx(STAND_SECONDS)
    episode.close()


def test_hard_push_throws_the_robot_over_and_a_soft_one_does_not() -> None:
    def pushed(newtons: float) -> EpisodeResult:
        push = Push(newtons=(newtons, newtons), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0))
        config = BalanceConfig(push=push, time_limit=5.0, randomisation=Randomisation(enabled=False))
        return simulate(EpisodeSpec((1.0, 0.0, 1.0, 0.0), 0, "balance", config))

    assert pushed(40.0).survived
    thrown = pushed(300.0)
    assert thrown.termination == "left_box" and thrown.final_position[1] > 0.2
    assert 2.15 < thrown.duration < 3.0


def test_push_is_the_only_difference_between_forces() -> None:
    """The force changes neither direction nor time of the push, nor the episode's other draws."""
    soft, hard = (draw_push(Push(newtons=(newtons, newtons)), seed=5) for newtons in (50.0, 100.0))
    assert hard.begin == soft.begin
    assert hard.force == pytest.approx(tuple(2 * component for component in soft.force))


def test_pushes_cover_every_direction_force_and_time() -> None:
    pushes = [draw_push(Push(), seed) for seed in range(400)]
    newtons = [np.hypot(*push.force[:2]) for push in pushes]
    assert min(newtons) < 5.0 and 95.0 < max(newtons) <= 100.0
    quadrants = {(push.force[0] > 0, push.force[1] > 0) for push in pushes}
    assert len(quadrants) == 4 and all(push.force[2] == 0.0 for push in pushes)
    begins = [push.begin for push in pushes]
    assert 1.0 <= min(begins) < 1.1 and 3.9 < max(begins) <= 4.0


def test_push_lasts_as_long_as_it_says() -> None:
    class Pushed(NoPhysics):
        forces: list[tuple[float, float, float]]

        def push(self, force: tuple[float, float, float]) -> None:
            self.forces.append(force)

    Pushed.forces = []
    push = Push(newtons=(80.0, 80.0), degrees=(0.0, 0.0), at_seconds=(2.0, 2.0), duration=0.15)
    episode = Episode(BalanceConfig(push=push), 0, BALANCE, build=Pushed)
    episode.stand()
    episode.run((1.0, 0.0, 1.0, 0.0))
    assert Pushed.forces == [(80.0, 0.0, 0.0)] * 15


def test_balance_without_v_and_without_a_push_steps_as_in_the_first_training() -> None:
    config = BalanceConfig(push=Push(newtons=(0.0, 0.0)), time_limit=4.0, stepping=PAPER_STEPPING)
    balance = simulate(EpisodeSpec((0.0,) * 4, 1, "balance", config))
    assert balance == simulate(EpisodeSpec(PAPER_STEPPING, 1, "stepping", config))


def test_episode_runs_at_another_control_rate() -> None:
    config = EpisodeConfig(physics=Physics(rate=400, control_rate=200), time_limit=6.0)
    result = simulate(EpisodeSpec(PAPER_STEPPING, 0, config=config), record_trace=True)
    assert result.survived and result.steps > 5 and result.trace is not None
    assert np.allclose(np.diff(result.trace.time), 0.005)


def shaken_by(amplitude: float) -> Evaluation:
    """The same episode, with flexions that a controller shakes at half the control rate."""
    episode = Episode(SHORT, 0)
    episode.stand()
    episode.start(PAPER_STEPPING)
    send = episode.simulation.set_targets

    def shaken(targets: tuple[float, ...]) -> None:
        flexion = amplitude if round(episode.simulation.time / CONTROL_DT) % 2 else -amplitude
        send((*targets[:2], flexion, flexion, *targets[4:]))

    episode.simulation.set_targets = shaken  # type: ignore[method-assign]
    while episode.termination is None:
        episode.tick()
    episode.close()
    return Evaluation([episode.result()])


def test_chattering_hips_show_as_vibration() -> None:
    calm, chattering = shaken_by(0.0), shaken_by(0.02)
    assert chattering.chatters(without=calm) and not calm.chatters(without=calm)
    assert chattering.mean("actuator_power") > calm.mean("actuator_power")
    assert chattering.peak_hip_rate_max > 10 * calm.peak_hip_rate_max
