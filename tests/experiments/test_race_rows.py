"""A race's rankings come from the rows of its trainings."""

from pandas import DataFrame

from experiments.robot.race import columns, curve_of, ranked
from sarah.reports.race_entry import RaceCurve


def training(seed: int, algorithm: str, final: tuple[float, ...], learning: float) -> dict[str, object]:
    """Row of a training of 5 episodes."""
    curve = RaceCurve(algorithm, (5, 5), (0.5, final[0]), final, 1, 2.0)
    return {"task": "stepping", "seed": seed, "algorithm": algorithm, **columns(curve, learning)}


def test_a_row_holds_the_curve_of_its_training() -> None:
    curve = RaceCurve("naf", (5, 10, 10), (0.25, 0.5, 0.75), (0.75, 0.1234), 1, 2.0)
    row = {"algorithm": "naf", **columns(curve, 0.5)}
    assert curve_of(row) == curve


def test_only_seeds_with_all_algorithms_are_ranked() -> None:
    rows = [
        training(0, "naf", (0.5, 0.7), 0.2),
        training(0, "tpe", (0.6, 0.9), 0.4),
        training(1, "naf", (0.7, 0.9), 0.3),
        training(1, "tpe", (0.7, 0.9), 0.5),
        training(2, "naf", (0.0, 0.0), 0.0),
    ]
    naf, tpe = ranked(DataFrame(rows), "stepping").set_index("algorithm").loc[["naf", "tpe"]].to_dict("records")
    assert (naf["runs"], tpe["runs"]) == (2, 2)
    assert (round(naf["final_score"], 9), round(tpe["over_naf"], 9)) == (0.7, 0.075)
    assert (round(naf["score_while_learning"], 9), round(naf["score_while_learning_error"], 9)) == (0.25, 0.05)
