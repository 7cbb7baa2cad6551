"""Filters of signals and targets."""

from sarah.robot.filters import clipped, ramped


def test_a_ramp_goes_by_its_largest_change_and_a_clip_ends_at_its_limit() -> None:
    goals = (-1.0, -0.05, 0.05, 1.0)
    assert (
        [ramped(0.0, goal, 0.1) for goal in goals] == [clipped(goal, 0.1) for goal in goals] == [-0.1, -0.05, 0.05, 0.1]
    )
