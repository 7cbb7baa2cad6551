"""The claims of the paper."""

import re
from collections import Counter

import pytest
from pandas import Series

from experiments.record import ROOT
from experiments.robot.first_training import settling

NUMBERS = {1: "one", 2: "two", 3: "three", 4: "four", 5: "five", 6: "six", 7: "seven", 14: "fourteen"}


def test_the_page_counts_what_its_tables_say() -> None:
    page = (ROOT / "docs/results/claims.md").read_text(encoding="utf-8")
    verdicts = Counter(re.findall(r"^\| [^|]+ \| (yes|in part|no|not tested) \|", page, re.MULTILINE))
    total, yes, part, no, untested = (
        NUMBERS[count]
        for count in (verdicts.total(), *(verdicts[key] for key in ("yes", "in part", "no", "not tested")))
    )
    said = f"Of {total} claims {yes} hold, {part} hold in part, and {no} do not; {untested} was not tested."
    assert said in " ".join(page.split())


@pytest.mark.parametrize(
    ("values", "verdict"), [([0.31, 0.5], "yes"), ([0.31, 0.6], "in part"), ([0.31, 0.6, 0.2], "no")]
)
def test_a_parameter_settles_if_trainings_end_near_the_claimed_value(values: list[float], verdict: str) -> None:
    assert settling(Series(values, name="P1"), 0.4)[1] == verdict
