"""Which files have mutants, which tests have to kill them, and which mutants nothing can kill."""

from __future__ import annotations

from typing import NamedTuple


class Subject(NamedTuple):
    """A file whose mutants are tested.

    :param file: name of the file
    :param tests: arguments of pytest that select the fast tests of its package
    :param definitions: regular expression of the functions and classes that are changed; empty names are the module's
    """

    file: str
    tests: str
    definitions: str = ".*"


CONTROL = "tests/control --ignore tests/control/test_any_readings.py -k 'not episode and not papers and not short'"
EPISODE = "tests/episode/test_gait_and_reward.py"
ENDING = "tests/episode/test_ending.py -k criteria"
SENSORS = "tests/simulation/test_sensors.py"
CRITIC = "tests/agents/test_naf_equations.py"
TARGETS = "tests/agents/test_naf_targets.py"
BUFFERS = "tests/agents/test_rank_buffer.py"

SUBJECTS = (
    Subject("sarah/control/pattern_generator.py", CONTROL),
    Subject("sarah/control/hip_law.py", CONTROL),
    Subject("sarah/control/constants.py", CONTROL, "ControllerConstants"),
    Subject("sarah/control/parameters.py", CONTROL),
    Subject("sarah/episode/reward.py", EPISODE),
    Subject("sarah/episode/gait.py", EPISODE),
    Subject("sarah/episode/ending.py", ENDING),
    Subject("sarah/simulation/sensors.py", SENSORS),
    Subject("agents/critic.py", CRITIC),
    Subject("agents/buffers.py", BUFFERS),
    Subject("agents/naf.py", TARGETS, "train"),
)
"""All but simulations of whole episodes. Of the constants those that compute: the limits beside them catch a mistaken
unit, and are rough. Of NAF its updates, with the equations."""

EXCLUDED = (
    r"core/("
    r"RemoveDecorator"  # without @property everything fails
    r"|ReplaceBinaryOperator_BitOr_.*"  # stands in annotations only
    r"|.*_(RShift|LShift|BitOr|BitAnd|BitXor|FloorDiv|Mod|Pow)"  # mostly errors on floats
    r"|.*_(Is|Invert|UAdd|USub_Not)|ReplaceComparisonOperator_(?!Is_).*_IsNot"  # errors, or the same as another
    r"|ReplaceComparisonOperator_Is(Not)?_(?!Is).*"  # the same for members of an enumeration and None
    r")"
)
"""Cosmic Ray's operators whose mutants say nothing: they would be killed by almost any test, or by none."""

EXPLAINED: dict[str, dict[str, str]] = {}
"""Mutants that no test can kill: for each file, the changed line and the reason."""
