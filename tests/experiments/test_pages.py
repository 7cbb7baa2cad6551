"""The pages show today's results, and read as they lie."""

import re
from collections import Counter
from pathlib import Path

import pytest
from laboratory import need
from pandas import DataFrame, Series

from experiments import record
from experiments.found import paths_of
from experiments.pages import write
from experiments.record import ROOT
from experiments.robot.first_training import settling
from experiments.tables import heading, shown, span, table, turned_table

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
    code = write("--check")
    assert code == 0, f"run make results: {capsys.readouterr().out}"


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
def test_a_parameter_settles_if_trainings_end_near_the_claimed_value(values: list[float], verdict: str) -> None:
    assert settling(Series(values, name="P1"), 0.4)[1] == verdict
