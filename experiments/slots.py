"""How busy workers are: episodes in flight consumed in order, against rounds of episodes that wait for the slowest.

A simulation of the schedule, over the lengths of the episodes of a training, in which the learner takes no time.
"""

from __future__ import annotations

import argparse
import heapq
import random
from collections.abc import Sequence
from pathlib import Path

from sarah.runs.run_folder import RunFolder

WORKERS = (2, 8, 64, 1000)
SLOTS_PER_WORKER = (1, 1.5, 2, 3, 4, 8)
EPISODES_PER_WORKER = 200


def efficiency_in_order(lengths: Sequence[float], workers: int, slots: int) -> float:
    """Share of the time that workers simulate, if an episode is handed in once the one ``slots`` before is consumed."""
    free = [0.0] * workers
    consumed: list[float] = []
    for index, length in enumerate(lengths):
        handed_in = consumed[index - slots] if index >= slots else 0.0
        begin = max(heapq.heappop(free), handed_in)
        heapq.heappush(free, begin + length)
        consumed.append(max(begin + length, consumed[-1] if consumed else 0.0))
    return sum(lengths) / (workers * consumed[-1])


def efficiency_in_rounds(lengths: Sequence[float], workers: int, slots: int) -> float:
    """The same, if ``slots`` episodes begin together once all of those before are over."""
    elapsed = 0.0
    for first in range(0, len(lengths), slots):
        free = [0.0] * workers
        for length in lengths[first : first + slots]:
            heapq.heappush(free, heapq.heappop(free) + length)
        elapsed += max(free)
    return sum(lengths) / (workers * elapsed)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("run", type=Path, help="folder of a training, for the lengths of its episodes")
    options = parser.parse_args()
    measured = [float(row["duration"]) for row in RunFolder(options.run).episodes()]
    generator = random.Random(0)
    print(f"| workers | schedule | {' | '.join(f'{ratio:g} slots a worker' for ratio in SLOTS_PER_WORKER)} |")
    print("|---" * (2 + len(SLOTS_PER_WORKER)) + "|")
    for workers in WORKERS:
        lengths = generator.choices(measured, k=EPISODES_PER_WORKER * workers)
        for name, efficiency in (("in order", efficiency_in_order), ("in rounds", efficiency_in_rounds)):
            cells = (f"{efficiency(lengths, workers, round(ratio * workers)):.2f}" for ratio in SLOTS_PER_WORKER)
            print(f"| {workers} | {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
