"""What a log says in a few numbers, and whether all of it is there."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass, field
from itertools import pairwise
from statistics import fmean

from sarah.drivers.real_time import LATE_SECONDS
from sarah.logs.reading import Log, Message
from sarah.logs.topic import Values
from sarah.logs.topics import PARAMETER_CHANGES, PHASE_CHANGES, STATES, TICKS, TOPICS, WINDOWS

_LATE = re.compile(rb'"late_seconds":\s*(-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?)')
"""The one value of a tick that a summary needs: decoding all of them would take five times as long."""


@dataclass
class Summary:
    """Summary of a log, filled message by message.

    :param log: log, whose messages have been read
    :param ticks: number of ticks in the log
    :param begin: time of the first tick, in s
    :param end: time of the last tick, in s
    :param late: number of ticks that began more than :data:`LATE_SECONDS` late
    :param worst: largest delay of a tick, in s
    :param missing: numbers of messages that are missing between others, by topic
    :param gaps: times before which messages of a topic are missing, in s
    :param states: values of the changes of the state
    :param ended: number of the ends of each phase
    :param by_sensors: number of those that sensors made
    :param steps: number of steps
    :param parameters: values of the parameters that were asked for
    :param windows: values of the windows
    """

    log: Log
    ticks: int = 0
    begin: float = 0.0
    end: float = 0.0
    late: int = 0
    worst: float = 0.0
    missing: Counter[str] = field(default_factory=Counter)
    gaps: list[float] = field(default_factory=list)
    states: list[Values] = field(default_factory=list)
    ended: Counter[str] = field(default_factory=Counter)
    by_sensors: Counter[str] = field(default_factory=Counter)
    steps: int = 0
    parameters: list[Values] = field(default_factory=list)
    windows: list[Values] = field(default_factory=list)

    @property
    def seconds(self) -> float:
        """Time from the first tick to the last one, in s."""
        return self.end - self.begin

    @property
    def dropped(self) -> int:
        """Number of messages that were dropped, as the log says itself, or as their numbers tell."""
        said = self.log.end.get("dropped", "")
        return max(self.missing.total(), int(said) if said.isdecimal() and len(said) < 19 else 0)

    @property
    def stepping_seconds(self) -> float:
        """Time in the state ``stepping``, in s; all of it if no state is known."""
        before = self.states[0]["before"] if self.states else "stepping"
        changes = [(self.begin, before), *((one["seconds"], one["state"]) for one in self.states), (self.end, "")]
        return sum(max(0.0, end - begin) for (begin, state), (end, _) in pairwise(changes) if state == "stepping")

    @property
    def steps_per_second(self) -> float:
        """Steps per second while it stepped."""
        return self.steps / self.stepping_seconds if self.stepping_seconds else 0.0

    @property
    def observed_reward(self) -> float | None:
        """Mean of the rewards that the windows observed; ``None`` without a window."""
        rewards = [window["observed_reward"] for window in self.windows if "observed_reward" in window]
        return fmean(rewards) if rewards else None

    def add_tick(self, message: Message) -> None:
        """Count a tick.

        :param message: message of ``/ticks``
        """
        if self.ticks == 0:
            self.begin = self.log.values(message)["seconds"]  # all of it is checked, once
        self.ticks += 1
        self.end = message.nanoseconds / 1e9
        found = _LATE.search(message.data)
        if found is not None:
            late = float(found[1])
            self.late += late > LATE_SECONDS
            self.worst = max(self.worst, late)

    def add_phase_change(self, values: Values) -> None:
        """Count the end of a phase.

        :param values: values of a message of ``/phase_changes``
        """
        self.ended[values["ended"]] += 1
        self.by_sensors[values["ended"]] += values["by_sensors"]
        self.steps += values["is_step"]


def summarise(log: Log, whole: bool = False) -> Summary:
    """Read a log, and summarise it.

    :param log: log to read
    :param whole: whether to decode and check every message, and not only what the summary needs
    :raises ConfigurationError: if it is no log of this package
    """
    summary, expected = Summary(log), dict.fromkeys(TOPICS, -1)
    kept = {STATES.name: summary.states, PARAMETER_CHANGES.name: summary.parameters, WINDOWS.name: summary.windows}
    for message in log.messages():
        topic, sequence = message.topic, message.sequence
        if sequence > expected[topic] >= 0:
            summary.missing[topic] += sequence - expected[topic]
            summary.gaps.append(message.seconds)
        expected[topic] = sequence + 1
        if topic == TICKS.name:
            summary.add_tick(message)
            if whole:
                log.values(message)
        elif topic == PHASE_CHANGES.name:
            summary.add_phase_change(log.values(message))
        else:
            kept[topic].append(log.values(message))
    return summary
