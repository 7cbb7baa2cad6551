"""How fine must the physics be? Score and steps per second of six parameter sets in 12 s, and speed, by setting."""

from __future__ import annotations

import time

from sarah.config import EpisodeConfig, Physics
from sarah.episode import EpisodeSpec, simulate

PARAMETERS = (
    (0.02, 0.05, 0.55, 1.8, 1.3),
    (0.15, 0.3, 0.25, 0.5, 0.5),
    (0.3, 0.6, 0.1, 0.5, 0.5),
    (0.37, 0.3, 0.1, 1.0, 1.0),
    (0.42, 0.39, 0.91, 0.5, 1.2),
    (0.5, 0.8, 0.1, 1.0, 1.0),
)
SETTINGS = ((200, 30), (500, 30), (500, 60), (1000, 10), (1000, 20), (1000, 50), (1000, 100), (2000, 100))


def main() -> None:
    print("| rate, iterations |", " | ".join(str(parameters) for parameters in PARAMETERS), "| x real time |")
    print("|---" * (len(PARAMETERS) + 2) + "|")
    for rate, iterations in SETTINGS:
        config = EpisodeConfig(physics=Physics(rate=rate, solver_iterations=iterations), time_limit=12.0)
        start = time.process_time()
        results = [simulate(EpisodeSpec(parameters, seed=0, config=config)) for parameters in PARAMETERS]
        speed = sum(result.duration for result in results) / (time.process_time() - start)
        cells = [f"{result.score:.2f} ({result.steps_per_second:.1f})" for result in results]
        print(f"| {rate} Hz, {iterations} |", " | ".join(cells), f"| {speed:.0f} |", flush=True)


if __name__ == "__main__":
    main()
