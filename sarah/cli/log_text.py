"""What ``sarah-log`` prints of a log."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from sarah.drivers.real_time import LATE_SECONDS
from sarah.logs.summary import Summary

MOST_STATES = 10
"""Largest number of changes of the state that are printed."""

Row = tuple[str, str]


def verdict(summary: Summary) -> str:
    """Whether a log is whole, or where it is not.

    :param summary: summary of the log
    """
    problem = summary.log.problem
    if problem is not None:
        last = f"after {summary.end:.2f} s" if summary.ticks else "before its first chunk was complete"
        return f"{problem}, {last}"
    if summary.gaps:
        return f"{_gaps(summary)}, the first before {summary.gaps[0]:.2f} s"
    return f"ends with {_count(summary.dropped, 'message')} missing" if summary.dropped else "whole"


def rows_of(summary: Summary) -> Iterator[Row]:
    """Labels and texts of the rows.

    :param summary: summary of the log
    """
    log = summary.log
    written = [log.about[name] for name in ("program", "started") if name in log.about]
    yield "log", ", ".join([str(log.path), *written])
    yield "file", verdict(summary)
    yield "duration", f"{summary.seconds:.2f} s from {summary.begin:.2f} s"
    yield "ticks", f"{summary.ticks}; {_count(summary.dropped, 'message')} dropped"
    late = f"{_count(summary.late, 'tick')} by more than {1e3 * LATE_SECONDS:g} ms"
    yield "late", f"{late}, the worst {1e3 * summary.worst:.2f} ms"
    yield from _rows_of_states(summary)
    yield "steps", f"{summary.steps}, {summary.steps_per_second:.2f} per second of stepping"
    ends = (
        f"{phase.upper()} {100.0 * summary.by_sensors[phase] / summary.ended[phase]:.1f} %"
        for phase in ("shift", "lift", "land")
        if summary.ended[phase]
    )
    yield "ended by sensors", ", ".join(ends) or "no phase"
    yield from _rows_of_parameters(summary)
    if summary.windows:
        falls = sum(window["fell"] for window in summary.windows)
        reward = summary.observed_reward
        observed = "" if reward is None else f", observed reward {reward:.3f} on average"
        yield "windows", f"{len(summary.windows)}{observed}; falls: {falls}"


def _rows_of_states(summary: Summary) -> Iterator[Row]:
    shown = summary.states[:MOST_STATES]
    for index, values in enumerate(shown):
        yield "states" if index == 0 else "", f"{values['seconds']:.2f} s {values['state']}: {values['reason']}"
    if len(summary.states) > len(shown):
        counts = Counter(values["state"] for values in summary.states)
        every = ", ".join(f"{count} times {state}" for state, count in counts.items())
        yield "", f"and {len(summary.states) - len(shown)} more; in all {every}"


def _rows_of_parameters(summary: Summary) -> Iterator[Row]:
    asked = summary.parameters
    if not asked:
        return
    applied = [values for values in asked if values["accepted"]]
    refused = Counter(values["reason"] for values in asked if not values["accepted"])
    last = f", the last at {applied[-1]['seconds']:.2f} s by {applied[-1]['by']}" if applied else ""
    why = "".join(f"; refused: {count} times {reason}" for reason, count in refused.most_common(3))
    yield "parameters", f"{_count(len(asked), 'set')} asked for, {len(applied)} applied{last}{why}"


def _gaps(summary: Summary) -> str:
    missing = (f"{_count(count, 'message')} of {topic}" for topic, count in summary.missing.items())
    return f"has {_count(len(summary.gaps), 'gap')}: {' and '.join(missing)} missing"


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'' if number == 1 else 's'}"
