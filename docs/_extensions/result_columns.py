"""How the columns of results are shown: a heading that people read, with the unit, and as many digits as say something.

A column is named by what it holds and its unit, ``sole_clearance_mm``. Tables, pictures and sentences all ask here.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

UNITS = {
    "mm": "mm",
    "cm": "cm",
    "s": "s",
    "n": "N",
    "hz": "Hz",
    "kb": "kB",
    "mib": "MiB",
    "m2_s4": "m²/s⁴",
    "kg_m2": "kg m²",
}
"""Unit by the end of a column's name."""
HEADINGS = {
    "time_out_s": "time-out (s)",
    "sets_above_half": "sets above 0.5",
    "clocks_above_half": "clocks above 0.5",
    "told": "the generator is told",
    "episodes_to_80": "80 % after (episodes)",
    "episodes_to_90": "90 % after (episodes)",
    "episodes_to_95": "95 % after (episodes)",
    "reached_80": "80 % reached by",
    "reached_90": "90 % reached by",
    "held_90": "90 % held by",
    "held_95": "95 % held by",
    "final_at_95": "final score at 95 %",
    "sets_within_0_02": "sets within 0.02",
    "rms_distance": "root mean square distance",
    "naf_over_td3": "NAF over TD3",
    "mujoco_over_pybullet": "MuJoCo over PyBullet",
    "longer": "longer by",
    "below_0_1": "below 0.1",
    "score_0_to_3_min": "minutes 0 to 3",
    "score_3_to_5_min": "minutes 3 to 5",
    "score_5_to_8_min": "minutes 5 to 8",
    "score_from_8_min": "from minute 8",
}
"""Headings that do not follow from the column's name."""
WORDS = {"pybullet": "PyBullet:", "mujoco": "MuJoCo:", "naf": "NAF", "td3": "TD3", "mu": "mu,", "v": "V"}
"""Words of column names that are written otherwise."""
FORMATS = {
    "score": ".3f",
    "score_error": ".3f",
    "score_while_learning": ".3f",
    "score_while_learning_error": ".3f",
    "over_naf": "+.3f",
    "distance": ".3f",
    "survival": ".2f",
    "score_0_to_3_min": ".3f",
    "score_3_to_5_min": ".3f",
    "score_5_to_8_min": ".3f",
    "score_from_8_min": ".3f",
    "score_of_last_parameters": ".3f",
    "gain": "+.3f",
    "rank_correlation": ".3f",
    "mean_difference": "+.3f",
    "falls": ".2f",
    "share": ".2f",
    "sensors": ".2f",
    "per_second": ".2f",
    "updates_per_second": ".0f",
    "kept": ".0%",
    "longer": ".0%",
    "difference": "+.1%",
    "difference_error": ".1%",
    "return": ".1f",
    "mm": ".0f",
    "cm": ".1f",
    "m2_s4": ".1f",
    "mib": ".1f",
    "kb": ".0f",
    "wall_time_s": ".0f",
    "replayed_in_s": ".1f",
    "time": ".0f",
    "td3": ".2f",
    "over_bound": ".2f",
    "over_true": ".2f",
    "over_centre": ".2f",
    "curvature": ".2f",
    "v_error": ".0f",
    "true_change": ".1f",
    "std_of_error": ".1f",
    "correlation": ".2f",
}
"""Format by the end of a column's name; the longest that fits counts."""
DIGITS = 5
"""Characters of a number that is shown as it stands unless its column says otherwise."""
PARAMETER = re.compile(r"[PV]\d")


def heading(column: str) -> str:
    """What stands over a column.

    :param column: its name
    """
    if column in HEADINGS or PARAMETER.fullmatch(column):
        return HEADINGS.get(column, column)
    unit = next((unit for unit in UNITS if column.endswith(f"_{unit}")), "")
    words = column.removesuffix(f"_{unit}").split("_")
    text = " ".join(WORDS.get(word, word) for word in words)
    return f"{text} ({UNITS[unit]})" if unit else text


def shown(column: str, text: str, texts: Sequence[str]) -> str:
    """A cell as people read it: rounded, and never with more decimals than were recorded.

    :param column: name of the column
    :param text: what the file has
    :param texts: the whole column
    """
    if text == "inf":
        return "not reached"
    try:
        number = float(text)
    except ValueError:
        return text
    spec = with_decimals(format_of(column), most_decimals(texts))
    return typeset(text if spec.endswith("g") and len(text.strip("-0.")) <= DIGITS else format(number, spec))


def typeset(number: str) -> str:
    """A number with a minus sign and a space before the percent sign, none of which breaks a line.

    :param number: as Python writes it
    """
    return number.replace("%", "\N{NO-BREAK SPACE}%").replace("-", "\N{MINUS SIGN}")


def format_of(column: str) -> str:
    """Format of a column's numbers; empty if they are shown as they stand.

    :param column: its name
    """
    column = re.sub("_(low|high)$", "", column)
    if PARAMETER.fullmatch(column):
        return ".2f"
    fitting = [end for end in FORMATS if column == end or column.endswith(f"_{end}")]
    return FORMATS[max(fitting, key=len)] if fitting else ".3g"


def most_decimals(texts: Sequence[str]) -> int:
    """Largest number of decimals among numbers.

    :param texts: of a column
    """
    return max((len(text.partition(".")[2]) for text in texts if re.fullmatch(r"-?\d+\.\d+", text)), default=0)


def with_decimals(spec: str, most: int) -> str:
    """A format that shows no more decimals than there are.

    :param spec: format of a number or of a share in percent
    :param most: decimals of the recorded number
    """
    sign, decimals, kind = re.fullmatch(r"(\+?)\.(\d+)([f%g])", spec).groups()
    if kind == "g":
        return spec
    return f"{sign}.{min(int(decimals), max(0, most - 2 if kind == '%' else most))}{kind}"
