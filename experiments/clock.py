"""Is the pattern generator driven by its sensors, or can its time-outs be used as an open-loop clock?

Simulates random parameters, and the fastest clocks that there are (conditions that are never met, shortest
time-outs), with the time-outs as they are and with the faster ones that let clocks in.
"""

from __future__ import annotations

import argparse
import random

from sarah.control import pattern_generator
from sarah.episode.episode import simulate
from sarah.episode.evaluation import SMALLEST_EVENT_SHARE
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec

CLOCKS = ((0.05, 2.0, 2.0, 0.0, 0.0), (0.2, 0.0, 2.0, 0.0, 0.0), (1.0, 1.0, 1.0, 0.0, 0.0), (1.5, 0.5, 0.1, 0.0, 0.0))


def is_clock(result: EpisodeResult) -> bool:
    return min(result.event_driven_shift, result.event_driven_lift) < SMALLEST_EVENT_SHARE


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--random", type=int, default=40, help="how many random parameter sets")
    count = parser.parse_args().random
    generator = random.Random(0)
    drawn = [tuple(generator.uniform(0.0, 2.0) for _ in range(5)) for _ in range(count)]
    print("| time-out | random sets above 0.5 | of these clocks | best clock among all |")
    print("|---|---|---|---|")
    for seconds in (pattern_generator.TIME_OUT_SECONDS, 0.3):
        pattern_generator.TIME_OUT_SECONDS = seconds
        results = [simulate(EpisodeSpec(parameters, seed)) for seed, parameters in enumerate((*drawn, *CLOCKS))]
        good = [result for result in results[:count] if result.score > 0.5]
        best = max((result.score for result in results if is_clock(result)), default=0.0)
        print(f"| {seconds} s | {len(good)} of {count} | {sum(map(is_clock, good))} | {best:.2f} |", flush=True)


if __name__ == "__main__":
    main()
