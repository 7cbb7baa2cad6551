"""The table of a race: what counts as reached and held, how trainings are summed up, and how far to trust that."""

import csv
import math
from pathlib import Path

import numpy as np
import pytest

from sarah.reports.race_entry import RaceCurve
from sarah.reports.rankings import as_markdown, episodes_until, rankings, write_csv
from sarah.reports.uncertainty import best_known, difference, number_at, share_of, standard_error
from sarah.runs.config import ALGORITHMS


def curve(algo: str, *scores: float, final: tuple[float, ...] = ()) -> RaceCurve:
    """Scores of a training along the way; the last one is in all judging episodes unless their scores are given."""
    return RaceCurve(algo, tuple(5 * (index + 1) for index in range(len(scores))), scores, final or scores[-1:], 1, 1.0)


def test_a_score_counts_once_it_is_held() -> None:
    assert episodes_until(curve("naf", 0.2, 0.9, 0.3, 0.9, 0.9, 0.9), 0.8) == 20
    assert episodes_until(curve("naf", 0.9, 0.9, 0.9), 0.8) == 5
    assert math.isinf(episodes_until(curve("naf", 0.2, 0.9, 0.9), 0.8))
    # The last recommendation along the way is the final one too: two evaluations after the same episodes are one.
    assert math.isinf(episodes_until(RaceCurve("naf", (5, 10, 15, 15), (0.2, 0.9, 0.9, 0.9), (0.9,), 1, 1.0), 0.8))


def test_counts_are_ones_after_which_there_was_a_recommendation() -> None:
    early, late = curve("naf", 1, 1, 1, 1, 1, 1), curve("naf", 0, 0, 0, 1, 1, 1)
    (row,) = rankings([early, late]).rows
    assert row.episodes == {0.9: 20.0, 0.95: 20.0}  # not 12.5, after which nobody was asked
    (row,) = rankings([early, late, early]).rows
    assert row.episodes[0.9] == 5.0


def test_what_half_of_the_trainings_never_reach_is_not_reached(tmp_path: Path) -> None:
    table = rankings([curve("naf", 1, 1, 1), curve("naf", 0, 0, 0)])
    assert math.isinf(table.rows[0].episodes[0.9]) and table.rows[0].held[0.9] == 1
    assert "| 1 (0 to 2) | not reached | 1 | not reached | 1 |" in as_markdown(table)
    write_csv(table, tmp_path / "race.csv")
    (row,) = csv.DictReader((tmp_path / "race.csv").open())
    assert (row["episodes_to_90"], row["held_90"], row["episodes_to_95"], row["held_95"]) == ("inf", "1", "inf", "1")


def test_one_judging_episode_says_nothing_of_others() -> None:
    row, _ = rankings([curve("naf", 0.4), curve("naf", 0.5), curve("td3", 0.6), curve("td3", 0.8)]).rows
    assert row.over_reference == pytest.approx((0.25, math.nan, math.nan), nan_ok=True)


def test_the_way_is_compared_with_the_best_in_its_own_episodes() -> None:
    """The episode along the way is an unlucky one: 0.4 is the best known score in it, and held."""
    good = curve("naf", 0.4, 0.4, 0.4, final=(0.4, 1.0, 1.0, 1.0))
    late = curve("td3", 0.2, 0.2, 0.4, final=(0.4, 1.0, 1.0, 0.8))
    table = rankings([good, late])
    assert table.best == pytest.approx(0.85) and table.best_along == pytest.approx(0.4)
    by_name = {row.algo: row for row in table.rows}
    assert by_name["naf"].episodes[0.95] == 5.0 and math.isinf(by_name["td3"].episodes[0.95])
    assert by_name["naf"].held[0.95] == 1 and by_name["td3"].held[0.95] == 0
    assert by_name["td3"].at_share[0] == 0 and by_name["naf"].at_share[0] == 1


def test_the_quickest_comes_first_and_a_reference_is_compared() -> None:
    slow = [curve("td3", 0.1, 0.74, 0.74, 0.74, final=(0.74, 0.64)), curve("td3", 0.1, 0.1, 0.1, final=(0.1, 0.2))]
    good = [curve("naf", 0.78, 0.78, 0.8, final=(0.8, 0.8)), curve("naf", 0.8, 0.8, 0.8, final=(0.8, 0.7))]
    table = rankings([slow[0], good[0], slow[1], good[1]], reference="naf")
    first, second = table.rows
    assert (first.algo, second.algo) == ("naf", "td3")
    assert first.runs == 2 and first.episodes == {0.9: 5.0, 0.95: 5.0} and first.held == {0.9: 2, 0.95: 2}
    assert second.held == {0.9: 1, 0.95: 0} and math.isinf(second.episodes[0.95])
    assert first.score[0] == pytest.approx(0.775) and first.over_reference is None
    assert second.over_reference is not None and second.over_reference[0] == pytest.approx(0.42 - 0.775)
    assert rankings([*slow, *good]).reference == "td3"  # the first one, unless another is asked for


def test_a_table_names_its_columns_and_what_judged(tmp_path: Path) -> None:
    curves = [curve("naf", 0.8, final=(0.8, 0.9)), curve("td3", 0.6, final=(0.6, 0.7))]
    table = rankings(curves)
    text = as_markdown(table)
    assert "| algorithm | runs | final score | over naf | final score at 95 % | 90 % held after | by |" in text
    assert "| naf | 1 | 0.850 ± 0.050 |  | 1 (0 to 1) | not reached | 0 |" in text
    assert "| td3 | 1 | 0.650 ± 0.050 | -0.200 | 0 (0 to 1) |" in text
    assert "\n2 unseen episodes judge every final recommendation, and the first 1 of them" in text
    assert "The best known score is 0.850, and 0.800 in the first 1." in text
    assert "\n- naf: chosen on the tasks stepping and balance" in text
    write_csv(table, tmp_path / "race.csv")
    naf, td3 = csv.DictReader((tmp_path / "race.csv").open())
    assert (naf["final_score_error"][:6], naf["over_naf"], naf["final_at_95_high"]) == ("0.0499", "", "1")
    assert td3["over_naf"][:4] == "-0.2" and td3["over_naf_low"] == ""  # of one seed there is no interval


def test_shares_are_of_a_known_best_score_and_may_be_below_zero() -> None:
    assert share_of(0.8, 0.95) == pytest.approx(0.76) and share_of(-1.0, 0.95) == pytest.approx(-1.05)
    table = rankings([curve("naf", 0.8, 0.8, 0.8)], best=2.0)
    assert table.rows[0].held == {0.9: 0, 0.95: 0} and table.rows[0].at_share == (0, 0, 1)
    assert table.best == table.best_along == 2.0
    (row,) = rankings([curve("naf", -9.0, -1.09, -1.0, -1.0, -1.0)]).rows
    assert row.episodes == {0.9: 10.0, 0.95: 15.0}


def test_the_origin_of_every_algorithms_settings_is_said() -> None:
    table = as_markdown(rankings([curve(algo, 0.1, 0.2) for algo in ALGORITHMS]))
    assert "- mine: nobody has said" in as_markdown(rankings([curve("mine", 0.1, 0.2)]))
    assert "- td3, sac, ddpg: set once by hand" in table and "- gp, tpe: the defaults of Optuna" in table


@pytest.mark.parametrize(
    ("scores", "variance"),
    [
        ([[0.2, 0.4, 0.6, 0.8]], 0.2 / 3 / 4),  # one training: that over its episodes
        ([[0.2], [0.4], [0.9]], 0.13 / 3),  # one episode: that over the trainings
        # Means of the trainings are 0.2 and 0.6, of the episodes 0.3, 0.3 and 0.6; what is left is 0.1 or 0.2 each.
        ([[0.2, 0.0, 0.4], [0.4, 0.6, 0.8]], (3 * 0.08 + 2 * 0.03 - 0.04 / 2) / 6),
        # Episodes are alike on average, which counts as not at all: only the trainings' means say something.
        ([[0.2, 0.4], [0.6, 0.4]], 2 * 0.02 / 4),
        # All means are alike, and every score is 0.5 off: the rest is the error, with one degree of freedom.
        ([[0.0, 1.0], [1.0, 0.0]], 4 * 0.25 / 4),
    ],
)
def test_the_error_is_over_trainings_and_episodes(scores: list[list[float]], variance: float) -> None:
    assert standard_error(np.array(scores)) == pytest.approx(math.sqrt(variance))


def test_luck_that_two_algorithms_share_is_no_difference() -> None:
    luck = np.array([0.0, 0.3, 0.6])
    found, low, high = difference(np.array([luck + 0.3, luck + 0.1]), np.array([luck, luck]))
    half = 12.706 * 0.1  # Student's factor for one degree of freedom; 0.3 and 0.1 have a standard error of 0.1
    assert (found, low, high) == pytest.approx((0.2, 0.2 - half, 0.2 + half), abs=1e-3)
    assert math.isnan(standard_error(np.array([[0.7]])))  # one training says nothing of other seeds
    found, *ends = difference(np.array([[0.5, 0.7]]), np.array([[0.4, 0.4]]))
    assert found == pytest.approx(0.2) and all(map(math.isnan, ends))


def test_episodes_judge_where_they_have_not_chosen() -> None:
    # The first training is best in episodes 0 and 2, the second in 1 and 3.
    scores = np.array([[0.9, 0.5, 0.7, 0.3], [0.2, 0.8, 0.4, 0.6]])
    assert best_known(scores) == pytest.approx(((0.5 + 0.3) / 2 + (0.2 + 0.4) / 2) / 2)
    # In episodes 0 and 1 the first is best, but the others choose the second for both.
    scores = np.array([[0.9, 0.9, 0.1, 0.1], [0.5, 0.7, 0.9, 0.9]])
    assert best_known(scores, 2) == pytest.approx((0.5 + 0.7) / 2)
    assert best_known(np.array([[0.4], [0.6]])) == pytest.approx(0.6)  # a single one does both


def test_the_interval_of_a_count_knows_the_luck_of_the_judge() -> None:
    """Of two equal trainings a dozen episodes find one 5 % better; the interval has both numbers."""
    lucky = np.array([0.9, 0.7] * 6)
    scores = np.array([lucky, lucky - [0.3, 0.0, 0.0, 0.3, *(0.0,) * 8]])
    assert number_at(scores, np.array([False, True]), 0.95) == (0, 0, 1)
    assert number_at(scores, np.array([True, True]), 0.95, best=0.5) == (2, 2, 2)
    for few in (1, 2, 3):  # they say nothing of others
        assert number_at(scores[:, :few], np.array([True, True]), 0.95, best=0.5) == (2, 0, 2)
    # What lifts one training in an episode lifts the best as well, as all meet the same ones.
    luck = 0.3 * np.random.default_rng(0).normal(size=40)
    assert number_at(np.array([0.8 + luck, 0.79 + luck, 0.4 + luck]), np.full(3, True), 0.95) == (2, 2, 2)
