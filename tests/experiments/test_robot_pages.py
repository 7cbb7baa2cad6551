"""What pages about the robot make of rows, by hand-computed values."""

from pandas import DataFrame
from pytest import approx

from experiments.robot import engines, landscape, physics


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
    (row,) = physics.beside_finest(
        DataFrame({**condition, "setting": ["reference", "standard"], "score": [0.8, 0.6]})
    ).itertuples()
    assert (row.setting, row.finest_score, row.difference) == ("standard", 0.8, approx(-0.25))
