"""The pages show today's results, read as they lie, and make of rows what one computes by hand."""

import dataclasses
import math
import re
from collections import Counter
from pathlib import Path

import pytest
from laboratory import need
from pandas import DataFrame, Series
from pytest import approx

from experiments import record
from experiments.found import paths_of
from experiments.pages import show, write
from experiments.record import ROOT
from experiments.robot import engines, hard_pushes, landscape, physics, race
from experiments.robot.conditions import askew, biased
from experiments.robot.first_training import settling
from experiments.robot.hard_pushes import difference
from experiments.robot.race import columns, complete, curve_of, ranked
from experiments.robot.recognised import BEST, CAREFUL, NEAREST, compared, verdicts
from experiments.tables import heading, shown, span, survived_pushes, table, turned_table
from sarah.reports.race_entry import RaceCurve
from sarah.runs.config import ALGORITHMS
from sarah.simulation.randomisation import SensorConditions

PAGES = [
    *record.ROOT.glob("*.md"),
    *(page for page in record.ROOT.glob("docs/**/*.md") if "generated" not in page.parts),
]
OF_MARKUP = re.compile(r"^ *(?:```|:::)+\{|\{[\w:.-]+\}`|\[\[\[|^:\w+:", re.MULTILINE)
"""Directives, roles, blocks outside comments, and options of directives: what plain readers show as it is."""
ROWS = DataFrame({"run": ["a", "a", "b"], "engine": ["x", "y", "x"], "score": [0.5, -0.25, 1.0]})


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(record.ROOT)))
def test_a_page_reads_in_any_reader(page: Path) -> None:
    if page.name == "api.md":  # the one page for the site
        return
    text = re.sub(r"<!--.*?-->", "", page.read_text(encoding="utf-8"), flags=re.DOTALL)
    assert not OF_MARKUP.findall(text)


def test_pages_hold_what_their_functions_write(capsys: pytest.CaptureFixture[str]) -> None:
    need("pybullet")  # without it the settings have another default engine
    code = write(check=True)
    assert code == 0, f"run make results: {capsys.readouterr().out}"


def test_a_figure_that_is_not_that_of_the_result_is_noticed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page, text = tmp_path / "page.md", '<!-- [[[cog show("landscape.answer") ]]] -->\n\nOld.\n\n<!-- [[[end]]] -->\n'
    page.write_text(text, encoding="utf-8")
    monkeypatch.setattr("experiments.pages.pages", lambda: [page])
    assert write(check=True) != 0 and page.read_text(encoding="utf-8") == text
    assert write() == 0 and write(check=True) == 0 and "The score depends" in page.read_text(encoding="utf-8")


def test_every_result_is_shown_on_a_page() -> None:
    texts = "\n".join(page.read_text(encoding="utf-8") for page in PAGES)
    assert not {name for name in record.names() if f'show("{name}.' not in texts}
    assert not set(re.findall(r'show\("(\w+)\.', texts)) - set(paths_of())


def test_headings_and_values_are_written_as_people_write_them() -> None:
    assert heading("sole_clearance_mm") == "sole clearance (mm)" and heading("score_low") == "from"
    assert heading("vibration_m2_s4") == "vibration (m²/s⁴)"
    written = ["\N{MINUS SIGN}0.13", "98\N{NO-BREAK SPACE}%", "3", "a"]
    assert [shown(value, spec) for value, spec in ((-0.126, ".2f"), (0.985, ".0%"), (3, ""), ("a", ".1f"))] == written
    assert shown(float("nan"), ".2f") == "\N{EN DASH}" and shown(float("inf"), ".0f") == "not reached"
    assert span(ROWS.score, ".2f") == "\N{MINUS SIGN}0.25 to 1.00"
    assert survived_pushes([1.0, 1.0], 100.0) == "every push of 100 N"
    assert survived_pushes([0.8, 1.0], 100.0) == "80 to 100\N{NO-BREAK SPACE}% of pushes of 100 N"


def test_a_table_can_be_turned() -> None:
    straight = table(ROWS, ["run", "score"], "Scores.", score=".1f").splitlines()
    assert straight[:2] == ["**Scores.**", ""] and straight[-1] == "| b | 1.0 |"
    turned = turned_table(ROWS, ["run"], "engine", "score", "Scores.", ".2f").splitlines()
    assert turned[2:] == [
        "| run | x | y |",
        "| --- | --- | --- |",
        "| a | 0.50 | \N{MINUS SIGN}0.25 |",
        "| b | 1.00 | \N{EN DASH} |",
    ]


NUMBERS = {1: "one", 2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven", 14: "fourteen"}


def test_the_page_counts_what_its_tables_say() -> None:
    page = (ROOT / "docs/results/claims.md").read_text(encoding="utf-8")
    verdicts = Counter(re.findall(r"^\| [^|]+ \| (yes|in part|no|not tested) \|", page, re.MULTILINE))
    found = [verdicts.total(), *(verdicts[verdict] for verdict in ("yes", "in part", "no", "not tested"))]
    total, yes, part, no, untested = map(NUMBERS.__getitem__, found)
    said = f"Of {total} claims {yes} hold, {part} hold in part, and {no} do not; {untested} was not tested."
    assert said in " ".join(page.split())


@pytest.mark.parametrize(
    ("values", "verdict"), [([0.31, 0.5], "yes"), ([0.31, 0.6], "in part"), ([0.31, 0.6, 0.2], "no")]
)
def test_a_parameter_settles_if_trainings_end_near_the_claim(values: list[float], verdict: str) -> None:
    assert settling(Series(values, name="P1"), 0.4)[1] == verdict


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


def test_a_difference_is_a_share_of_the_score_at_the_finest() -> None:
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


@pytest.mark.parametrize(("apart", "told"), [(30, "agree better there"), (3, "cannot be told")])
def test_engines_agree_better_only_by_more_than_chance(apart: int, told: str) -> None:
    """In PyBullet the standard physics loses some of 100 pushes that the reference physics survives."""
    outcomes = {"standard": ("l" * apart + "s" * (100 - apart), "s" * 100), "reference": ("s" * 99 + "l", "s" * 100)}
    rows = DataFrame(
        {"push_n": 125.0, "controller": "shipped V", "engine": engine, "physics": physics, "outcomes": pushes}
        for physics, both in outcomes.items()
        for engine, pushes in zip(("pybullet", "mujoco"), both, strict=True)
    )
    assert told in hard_pushes.answer(rows.assign(survival=rows.outcomes.str.count("s") / 100))


def test_a_page_says_that_options_were_others(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    former = dataclasses.replace(record.read("physics"), options="seeds=8, sets=6, time_limit=8.0")
    monkeypatch.setattr(record, "read", lambda name: former)
    show("physics.differences")
    said = " ".join(capsys.readouterr().out.split())
    assert "Its options were not those of today: seeds=8, sets=6, time_limit=8.0." in said
    former = dataclasses.replace(former, options=physics.FULL.options)
    show("physics.differences")
    assert "options" not in capsys.readouterr().out


def test_physics_is_said_to_be_too_coarse_if_it_is() -> None:
    rows = record.read("physics").table
    coarse = rows.assign(score=rows.score.where(rows.setting != "standard", 0.5 * rows.score))
    assert "The standard physics is too coarse. In 0 of " in physics.answer(coarse)


def training(seed: int, algorithm: str, final: tuple[float, ...], learning: float) -> dict[str, object]:
    curve = RaceCurve(algorithm, (5, 5), (0.5, final[0]), final, 1, 2.0)
    return {"task": "stepping", "seed": seed, "algorithm": algorithm, **columns(curve, learning)}


def test_a_row_holds_the_curve_of_its_training() -> None:
    curve = RaceCurve("naf", (5, 10, 10), (0.25, 0.5, 0.75), (0.75, 0.1234), 1, 2.0)
    row = {"algorithm": "naf", **columns(curve, 0.5)}
    assert curve_of(row) == curve


def test_only_seeds_with_all_algorithms_are_ranked() -> None:
    finals = {"naf": ((0.5, 0.7), (0.7, 0.9)), "tpe": ((0.6, 0.9), (0.7, 0.9))}
    rows = [
        training(seed, algorithm, finals.get(algorithm, ((0.1, 0.1),) * 2)[seed], 0.2 + 0.1 * seed)
        for seed in range(2)
        for algorithm in ALGORITHMS
    ]
    trainings = complete(DataFrame([*rows, training(2, "naf", (0.0, 0.0), 0.0)]), "stepping")
    naf, tpe = ranked(trainings).set_index("algorithm").loc[["naf", "tpe"]].to_dict("records")
    assert (naf["runs"], tpe["runs"]) == (2, 2)
    assert (round(naf["final_score"], 9), round(tpe["over_naf"], 9)) == (0.7, 0.075)
    assert (round(naf["score_while_learning"], 9), round(naf["score_while_learning_error"], 9)) == (0.25, 0.05)


def test_a_race_of_one_task_is_shown_before_the_other_is_run() -> None:
    rows = DataFrame([training(0, algorithm, (0.5, 0.7), 0.2) for algorithm in ALGORITHMS])
    assert "The race of the Second Training is still to be made." in race.answer(rows)
    assert "(seeds from 200 on: 1 of 20 so far)" in race.final_stepping(rows)
    assert race.way_balance(rows) == "*Still to be made.*"


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


def test_words_about_one_set_for_all_follow_the_intervals() -> None:
    """Both sessions of a robot differ by nearly the same, up or down, or by opposite amounts."""
    groups = {
        name: DataFrame(
            {"robot": "a", "seed": seed, "learner": learner, "first_3_min": 0.5 + sign * gain * (learner == NEAREST)}
            for seed, gain in enumerate(gains)
            for learner in (NEAREST, BEST)
        )
        for name, sign, gains in (("x", 1, (0.1, 0.1001)), ("y", -1, (0.1, 0.1001)), ("z", 1, (0.1, -0.1)))
    }
    assert verdicts(groups) == "ahead on x; behind on y; neither (the interval includes zero) on z"
