"""What pages about the robot make of rows, by hand-computed values."""

import math

from pandas import DataFrame
from pytest import approx

from experiments.robot import engines, landscape, physics
from experiments.robot.conditions import askew, biased
from experiments.robot.hard_pushes import difference
from experiments.robot.race import columns, curve_of, ranked
from experiments.robot.recognised import CAREFUL, NEAREST, compared
from sarah.reports.race_entry import RaceCurve
from sarah.simulation.randomisation import SensorConditions


def test_a_value_is_good_if_it_is_near_the_best_in_both_engines() -> None:
    scores = {"pybullet": (0.8, 0.5, 0.79, 0.9, 0.1), "mujoco": (0.8, 0.9, 0.81, 0.79, 0.1)}
    rows = DataFrame(
        {"parameter": "V1", "engine": engine, "value": value, "score": score}
        for engine, values in scores.items()
        for value, score in zip((-1.0, 0.0, 0.5, 1.0, 2.0), values, strict=True)
    )
    assert landscape.good_values(rows) == ({}, {"V1": "\N{MINUS SIGN}1 and 0.5 to 1"})
    assert landscape.good_values(rows[rows.engine == "mujoco"]) == ({"V1": "0"}, {})


def test_what_is_kept_is_the_score_in_the_other_engine() -> None:
    where = {"task": "balance", "learned_in": [None, "pybullet", "mujoco"]}
    rows = DataFrame({**where, "pybullet_score": [0.5, 0.8, 0.6], "mujoco_score": [0.6, 0.4, 0.8]})
    assert list(engines.of_trainings(rows).kept) == approx([0.5, 0.75])
    assert list(engines.of_sets(rows)["balance"].difference) == approx([0.2])


def test_a_difference_is_a_share_of_the_score_at_the_finest_setting() -> None:
    condition = {"parameters": "shipped", "control_rate_hz": 100, "sensors": "10 ms"}
    rows = DataFrame({**condition, "setting": ["reference", "standard"], "score": [0.8, 0.6]})
    (row,) = physics.beside_finest(rows).itertuples()
    assert (row.setting, row.finest_score, row.difference) == ("standard", 0.8, approx(-0.25))


def test_sensors_are_as_wrong_as_said_in_the_direction_drawn() -> None:
    drawn = SensorConditions(imu_tilt=(0.003, -0.004), pad_noise_density=0.4)
    two_degrees = math.pi / 90
    assert askew(drawn).imu_tilt == approx((0.6 * two_degrees, -0.8 * two_degrees))
    assert askew(drawn).pad_noise_density == 0.4
    assert biased(SensorConditions(angular_rate_bias=(0.01, -0.02, -0.001))).angular_rate_bias == (0.05, -0.05, -0.05)


def test_the_difference_counts_pushes_that_only_one_survives() -> None:
    """Of 98 pushes the first survives 9 that the other does not, and the other 3: middle 6 / 100, variance 12.64e-4."""
    ones, others = "s" * 9 + "l" * 3 + "s" * 86, "l" * 9 + "s" * 3 + "s" * 86
    found = list(difference(ones, others).values())
    assert found[0] == approx(6 / 98)
    error = ((13 - 0.36) / 100**2) ** 0.5
    assert found[1:] == approx((0.06 - 1.96 * error, 0.06 + 1.96 * error))
    # Nobody knows a difference exactly from 18 pushes: 0 +- 1.96 sqrt(1 / 20 / 20).
    assert tuple(difference("s" * 18, "s" * 18).values()) == approx((0.0, -1.96 / 20, 1.96 / 20))


def training(seed: int, algorithm: str, final: tuple[float, ...], learning: float) -> dict[str, object]:
    curve = RaceCurve(algorithm, (5, 5), (0.5, final[0]), final, 1, 2.0)
    return {"task": "stepping", "seed": seed, "algorithm": algorithm, **columns(curve, learning)}


def test_a_row_holds_the_curve_of_its_training() -> None:
    curve = RaceCurve("naf", (5, 10, 10), (0.25, 0.5, 0.75), (0.75, 0.1234), 1, 2.0)
    row = {"algorithm": "naf", **columns(curve, 0.5)}
    assert curve_of(row) == curve


def test_only_seeds_with_all_algorithms_are_ranked() -> None:
    rows = [training(0, "naf", (0.5, 0.7), 0.2), training(0, "tpe", (0.6, 0.9), 0.4)]
    rows += [training(1, "naf", (0.7, 0.9), 0.3), training(1, "tpe", (0.7, 0.9), 0.5)]
    rows += [training(2, "naf", (0.0, 0.0), 0.0)]
    naf, tpe = ranked(DataFrame(rows), "stepping").set_index("algorithm").loc[["naf", "tpe"]].to_dict("records")
    assert (naf["runs"], tpe["runs"]) == (2, 2)
    assert (round(naf["final_score"], 9), round(tpe["over_naf"], 9)) == (0.7, 0.075)
    assert (round(naf["score_while_learning"], 9), round(naf["score_while_learning_error"], 9)) == (0.25, 0.05)


def test_learners_are_compared_robot_by_robot() -> None:
    """Differences of 0, 0.2 on one robot and 0.3 on the other: means 0.1 and 0.3, and 12.71 times an error of 0.1."""
    scores = {("a", 0): (0.5, 0.5), ("a", 1): (0.7, 0.5), ("b", 0): (0.9, 0.6)}
    rows = DataFrame(
        {"robot": robot, "seed": seed, "learner": learner, "score": score}
        for (robot, seed), pair in scores.items()
        for learner, score in zip((NEAREST, CAREFUL), pair, strict=True)
    )
    found = compared(rows, "score", other=CAREFUL)
    assert (found.mean, found.high, found.sessions) == (approx(0.2), approx(0.2 + 1.2706, abs=1e-4), 3)
    assert math.isnan(compared(rows[rows.robot == "b"], "score").low)
