"""The table of learned parameters, from which pages, help texts and figures take what they say."""

import dataclasses
import math
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sarah.control.constants import STANDARD_CONSTANTS
from sarah.control.hip_law import BalanceParameters
from sarah.control.parameters import BALANCE_PARAMETERS, PAPER_STEPPING, STEPPING_PARAMETERS, Box, Parameter
from sarah.control.pattern_generator import Phase, PhaseChange, SteppingParameters
from sarah.errors import ConfigurationError


def test_p1_to_p5_are_positive_and_v1_to_v4_of_either_sign() -> None:
    for parameters, ends in ((STEPPING_PARAMETERS, (0.0, 2.0, 2.0)), (BALANCE_PARAMETERS, (-2.0, 2.0, 4.0))):
        assert {(each.low, each.high, each.width) for each in parameters} == {ends}
    p1, p4 = STEPPING_PARAMETERS[0], STEPPING_PARAMETERS[3]
    assert p1.label == "P1 (rad/s)" and p1.description == f"{p1.meaning}, in rad/s"
    assert p4.label == "P4" and p4.description == p4.meaning


ODD = Box((*BALANCE_PARAMETERS, Parameter("odd", 0.1, 0.7, "", "a range", "")))


def test_the_ends_and_the_centre_of_a_box_are_those_of_an_action() -> None:
    """What lies outside comes to the nearer end."""
    assert ODD.unscaled([-1.0] * 5) == (-2.0, -2.0, -2.0, -2.0, 0.1)
    assert ODD.unscaled([1.0] * 5) == (2.0, 2.0, 2.0, 2.0, 0.7)
    assert ODD.centre == pytest.approx((0.0, 0.0, 0.0, 0.0, 0.4))
    assert ODD.unscaled([-3.0, 3.0, 0.0, -1.1, 1.1]) == ODD.unscaled([-1.0, 1.0, 0.0, -1.0, 1.0])
    assert ODD.at_shares([-1.0, 2.0, 0.5, 0.0, 1.5]) == ODD.at_shares([0.0, 1.0, 0.5, 0.0, 1.0])


def test_parameters_out_of_their_box_are_refused() -> None:
    for values, message in (
        ((0.4, 1.3, 0.1, 1.0), r"parameters must be 5 numbers \(P1 to P5\), not 4"),
        ((0.4, 1.3, 0.1, 1.0, 1.0, 1.0), r"parameters must be 5 numbers \(P1 to P5\), not 6"),
        ((0.4, 1.3, 0.1, 1.0, math.nan), "P5 must be between 0 and 2, not nan"),
        ((-0.1, 1.3, 0.1, 1.0, 1.0), "P1 must be between 0 and 2, not -0.1"),
        ((0.4, 2.1, 0.1, 1.0, 1.0), "P2 must be between 0 and 2, not 2.1"),
    ):
        with pytest.raises(ConfigurationError, match=message):
            Box(STEPPING_PARAMETERS).checked(values)


def test_an_end_may_be_missed_by_the_rounding_of_32_bit_numbers() -> None:
    ends = {2.0: 2.0 + 2.0**-21, -2.0: -2.0 - 2.0**-21}  # two roundings of a number near 2
    assert ODD.checked([*[ends[2.0]] * 4, np.nextafter(np.float32(0.7), np.float32(1.0))]) == (2.0, 2.0, 2.0, 2.0, 0.7)
    lowest = [*[ends[-2.0]] * 4, np.nextafter(np.float32(0.1), np.float32(0.0))]
    assert ODD.checked(lowest) == (-2.0, -2.0, -2.0, -2.0, 0.1)
    for v1, odd in ((2.0000007, 0.4), (-2.0000007, 0.4), (0.0, 0.7000003), (0.0, 0.0999997)):
        with pytest.raises(ConfigurationError, match="must be between"):
            ODD.checked([v1, 0.0, 0.0, 0.0, odd])


@pytest.mark.parametrize("count", [4, 6])
def test_a_box_takes_a_value_for_each_parameter(count: int) -> None:
    for change in (ODD.clipped, ODD.shares, ODD.at_shares, ODD.scaled, ODD.unscaled):
        with pytest.raises(ValueError):
            change([0.5] * count)


@given(st.tuples(*[st.floats(-2.0, 2.0)] * 4, st.floats(0.1, 0.7)))
def test_values_are_their_actions_and_their_shares(values: tuple[float, ...]) -> None:
    assert ODD.unscaled(ODD.scaled(values)) == pytest.approx(values, abs=1e-12)
    assert ODD.at_shares(ODD.shares(values)) == pytest.approx(values, abs=1e-12)
    rounded = Box(ODD.parameters, decimals=3).at_shares(ODD.shares(values))
    assert rounded == tuple(round(value, 3) for value in rounded) == pytest.approx(values, abs=5.1e-4)


VALUES = (
    *(STANDARD_CONSTANTS, STEPPING_PARAMETERS[0], ODD, SteppingParameters(*PAPER_STEPPING)),
    *(BalanceParameters(1.0, 0.0, 0.0, 0.0), PhaseChange(Phase.LAND, by_sensors=True)),
)


@pytest.mark.parametrize("value", VALUES, ids=lambda value: type(value).__name__)
def test_values_of_a_controller_do_not_change(value: Any) -> None:
    """An episode is a function of its specification, so nothing may write to it."""
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(value, dataclasses.fields(value)[0].name, 0.0)
