"""The table of metrics: each number of an episode is explained, summarised and written once; and many episodes."""

import random
from dataclasses import replace

import pytest
from laboratory import CONTROL_DT, RESULT

from sarah import PHYSICS, BalanceConfig, EpisodeConfig, EpisodeSpec, Push
from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode
from sarah.episode.evaluation import SMALLEST_SENSOR_SHARE, STATISTICS, Evaluation, evaluate
from sarah.episode.result import METRICS
from sarah.episode.workers import Workers

OTHER = replace(RESULT, score=0.4, vibration=3.0, final_position=(0.0, 0.0, 0.8), termination="fell")


def test_every_number_of_a_result_is_a_metric_with_a_meaning() -> None:
    numbers = {name for name, value in RESULT.fields().items() if isinstance(value, (int, float))}
    assert numbers | {"drift"} == set(METRICS)
    for name, metric in METRICS.items():
        assert metric.meaning and metric.label and isinstance(getattr(RESULT, name), (int, float))
        assert set(metric.statistics) <= set(STATISTICS)


def test_a_value_is_shown_in_its_unit_for_people() -> None:
    shown = {name: METRICS[name].text(value) for name, value in (("sole_clearance", 0.0123), ("drift", 0.034))}
    assert shown == {"sole_clearance": "12.3 mm", "drift": "3.4 cm"}
    assert METRICS["score"].text(0.8) == "0.800"


def test_the_row_of_a_table_holds_every_number_once() -> None:
    columns = RESULT.columns()
    assert set(columns) == (set(METRICS) - {"episode_return", "drift"}) | {"return", "termination", "x", "y"}
    assert (columns["return"], columns["x"], columns["y"]) == (RESULT.episode_return, *RESULT.final_position[:2])
    assert all(columns[name] == getattr(RESULT, name) for name in METRICS if name in columns)


def test_an_evaluation_holds_every_statistic_of_the_table() -> None:
    summary = Evaluation((RESULT, OTHER)).summary()
    named = {f"{name}_{statistic}" for name, metric in METRICS.items() for statistic in metric.statistics}
    assert set(summary) == named | {"episodes", "survival_rate", "diverged"}
    assert summary["episodes"] == 2 and summary["survival_rate"] == 0.5 and summary["diverged"] == 0
    assert summary["score_mean"] == pytest.approx(0.6) and summary["score_median"] == pytest.approx(0.6)
    assert summary["score_std"] == pytest.approx(0.2) and summary["score_min"] == 0.4
    assert summary["drift_max"] == pytest.approx(0.05) and summary["vibration_median"] == 6.0


@pytest.mark.parametrize(
    ("changes", "is_gait"),
    [({}, True), ({"shifts_by_sensors": 0.89}, False), ({"lifts_by_sensors": 0.5}, False), ({"steps": 0}, True)]
    + [({"sole_clearance": clearance}, clearance >= 0.01) for clearance in (0.0099, 0.01)],
)
def test_a_gait_is_one_by_sensors_that_lifts_its_feet(changes: dict[str, float], is_gait: bool) -> None:
    assert Evaluation((replace(RESULT, **changes),)).is_gait == is_gait  # type: ignore[arg-type]


SHORT = EpisodeConfig(time_limit=4.0)


def shaken_by(amplitude: float) -> Evaluation:
    """The same episode, with flexions that a controller shakes at half the control rate."""
    with Episode(SHORT, 0) as episode:
        episode.stand()
        simulation = episode.robot.simulation
        send = simulation.set_targets

        def shaken(targets: tuple[float, ...]) -> None:
            flexion = amplitude if round(simulation.time / CONTROL_DT) % 2 else -amplitude
            send((*targets[:2], flexion, flexion, *targets[4:]))

        simulation.set_targets = shaken  # type: ignore[method-assign]
        return Evaluation((episode.run(PAPER_STEPPING),))


def test_chattering_hips_show_as_vibration() -> None:
    calm, chattering = shaken_by(0.0), shaken_by(0.02)
    assert chattering.chatters(calm) and not calm.chatters(calm)
    assert chattering.mean("actuator_power") > calm.mean("actuator_power")
    assert chattering.statistic("peak_hip_rate", "max") > 10 * calm.statistic("peak_hip_rate", "max")


@pytest.mark.slow
def test_papers_parameters_step_on_20_seeds(workers: Workers) -> None:
    evaluation = evaluate("stepping", PAPER_STEPPING, EpisodeConfig(), range(20), workers)
    assert evaluation.survivors >= 19
    assert all(2.3 <= result.steps_per_second <= 3.5 for result in evaluation.results if result.survived)
    assert evaluation.statistic("drift", "max") < 0.08
    assert evaluation.median("score") >= 0.78


@pytest.mark.slow
def test_no_clock_among_random_parameters_pays(workers: Workers) -> None:
    generator = random.Random(0)
    drawn = [tuple(generator.uniform(0.0, 2.0) for _ in range(5)) for _ in range(60)]
    results = workers.simulate_all([EpisodeSpec(parameters, seed) for seed, parameters in enumerate(drawn)])
    shares = [(min(result.shifts_by_sensors, result.lifts_by_sensors), result.score) for result in results]
    clocks = [score for share, score in shares if share < SMALLEST_SENSOR_SHARE]
    assert len(clocks) > 10 and max(clocks) < 0.6


@pytest.mark.slow
def test_v1_saves_the_robot_from_pushes_to_the_side(workers: Workers) -> None:
    """Forty pushes of 100 N from the sides: at V = 0 about 6 in 10 survive, with V1 = 1 nearly all.

    At the reference physics; at the standard one a few more fall.
    """
    push = Push(newtons=(100.0, 100.0), at_seconds=(2.0, 4.0))
    survived = {}
    for v1 in (0.0, 1.0):
        specs = []
        for seed in range(40):
            side = (0.0, 0.0) if seed % 2 else (180.0, 180.0)
            pushed = replace(push, degrees=side)
            config = BalanceConfig(physics=PHYSICS["reference"], push=pushed, time_limit=8.0)
            specs.append(EpisodeSpec((v1, 0.0, 0.0, 0.0), seed, "balance", config))
        survived[v1] = sum(result.survived for result in workers.simulate_all(specs))
    assert survived[1.0] >= 38 and survived[1.0] >= survived[0.0] + 8
