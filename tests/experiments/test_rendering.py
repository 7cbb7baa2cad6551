"""How the documentation shows results: headings, digits, and figures in sentences."""

import importlib
import sys
from types import ModuleType

import pytest

from experiments import record

EXTENSIONS = str(record.ROOT / "docs" / "_extensions")


@pytest.fixture(scope="module")
def columns() -> ModuleType:
    sys.path.insert(0, EXTENSIONS)
    return importlib.import_module("result_columns")


@pytest.fixture(scope="module")
def rows(columns: ModuleType) -> ModuleType:
    return importlib.import_module("result_rows")


def test_headings_have_units(columns: ModuleType) -> None:
    assert columns.heading("sole_clearance_mm") == "sole clearance (mm)"
    assert columns.heading("vibration_m2_s4") == "vibration (m²/s⁴)"
    assert columns.heading("steps_per_second") == "steps per second"
    assert columns.heading("P1") == "P1"


@pytest.mark.parametrize(
    ("column", "text", "shown"),
    [
        ("score", "0.91234", "0.912"),
        ("score", "0.91", "0.91"),
        ("kept", "0.98", "98\N{NO-BREAK SPACE}%"),
        ("difference", "-0.012", "\N{MINUS SIGN}1.2\N{NO-BREAK SPACE}%"),
        ("survival_low", "0.71333", "0.71"),
        ("episodes", "200", "200"),
        ("episodes_to_90", "inf", "not reached"),
        ("algorithm", "naf", "naf"),
        ("ratio", "2.0", "2.0"),
    ],
)
def test_a_number_has_as_many_digits_as_say_something(columns: ModuleType, column: str, text: str, shown: str) -> None:
    assert columns.shown(column, text, [text]) == shown


TABLE = [
    {"run": "paper", "P1": "0.40", "score": "0.909"},
    {"run": "naf seed 0", "P1": "0.02", "score": "0.903"},
    {"run": "naf seed 1", "P1": "0.44", "score": "0.912"},
]


@pytest.mark.parametrize(
    ("sentence", "figure"),
    [
        ("value table.score where run=paper", "0.909"),
        ("median table.score where run=naf* as .2f", "0.91"),
        ("range table.P1 where run=naf*", "0.02 to 0.44"),
        ("count table where run=naf* and P1>=0.3", "1"),
        ("max table.score as .0%", "91\N{NO-BREAK SPACE}%"),
    ],
)
def test_a_figure_in_a_sentence(rows: ModuleType, monkeypatch: pytest.MonkeyPatch, sentence: str, figure: str) -> None:
    result = record.Result("table", TABLE, "", "", "", "", {}, None)
    monkeypatch.setattr(record, "read", lambda name: result)
    assert rows.figure(sentence) == figure


@pytest.mark.parametrize(
    ("sentence", "message"),
    [
        ("value table.score", "finds 3 rows"),
        ("value table.speed where run=paper", "no column 'speed'"),
        ("value table.score where steps=3", "no condition on the columns run, P1, score"),
        ("mode table.score", "begins with none of"),
    ],
)
def test_a_figure_that_there_is_not_is_an_error(
    rows: ModuleType, monkeypatch: pytest.MonkeyPatch, sentence: str, message: str
) -> None:
    monkeypatch.setattr(record, "read", lambda name: record.Result("table", TABLE, "", "", "", "", {}, None))
    with pytest.raises(ValueError, match=message):
        rows.figure(sentence)
