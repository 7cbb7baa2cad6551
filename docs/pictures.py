"""Draws the pictures of README and docs: ``python docs/pictures.py`` writes them beside this file."""

from __future__ import annotations

from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

from sarah.config import TRAINED_STEPPING, EpisodeConfig, Randomisation
from sarah.episode import Episode
from sarah.pattern_generator import Phase, Side
from sarah.simulator import Camera
from sarah.trace import Trace

PARAMETERS = TRAINED_STEPPING
FROM_SECONDS, TO_SECONDS = 8.0, 8.75
FEET = Camera(height=0.17, distance=1.0, yaw=180.0, pitch=-3.0)
HERE = Path(__file__).parent


def main() -> None:
    episode = Episode(EpisodeConfig(randomisation=Randomisation(enabled=False)), seed=0, record_trace=True)
    whole = episode.simulation.render(480, 640)
    episode.stand()
    episode.start(PARAMETERS)
    closeups: dict[Phase, np.ndarray] = {}
    while episode.termination is None and episode.simulation.time < TO_SECONDS + 0.5:
        episode.tick()
        generator = episode.generator
        # The last frame of each phase of a step with the left leg swinging: where the phase has led to.
        if FROM_SECONDS < episode.simulation.time < TO_SECONDS and generator.swing is Side.LEFT:
            closeups[generator.phase] = episode.simulation.render(480, 640, FEET)
    trace = episode.result().trace
    assert trace is not None
    episode.close()
    draw_steps(whole, closeups)
    draw_cycle(trace)


def draw_steps(whole: np.ndarray, closeups: dict[Phase, np.ndarray]) -> None:
    pictures = {"SARAH standing": whole, **{f"end of {phase.name}": closeups[phase] for phase in list(Phase)[1:]}}
    figure, axes = plt.subplots(1, len(pictures), figsize=(12, 4.2))
    for axis, (title, picture) in zip(axes, pictures.items(), strict=True):
        axis.imshow(picture)
        axis.set_title(title)
        axis.axis("off")
    figure.tight_layout()
    figure.savefig(HERE / "stepping.png", dpi=100)


def draw_cycle(trace: Trace) -> None:
    shown = (trace.time >= FROM_SECONDS) & (trace.time <= TO_SECONDS)
    time = trace.time[shown]
    figure, axes = plt.subplots(4, 1, sharex=True, figsize=(8, 8))
    axes[0].plot(time, trace.stable_x[shown], color="black")
    axes[0].set_ylabel("stable_x (m/s²)")
    axes[1].plot(time, trace.angular_rate[shown][:, 1], color="black")
    for sign in (-1, 1):
        axes[1].axhline(sign * PARAMETERS[0], color="grey", linestyle="--", linewidth=0.8)
    axes[1].set_ylabel("rate about y (rad/s)\n(dashed: P1)")
    pads = trace.pressures[shown]
    axes[2].plot(time, pads[:, 0] + pads[:, 1], color="#2173b3", label="left")
    axes[2].plot(time, pads[:, 2] + pads[:, 3], color="#bf4033", label="right")
    axes[2].set_ylim(0, 600)
    axes[2].set_ylabel("pad load (N)")
    axes[2].legend(loc="upper right")
    axes[3].plot(time, 1000 * trace.joints[shown][:, 4], color="#2173b3")
    axes[3].plot(time, 1000 * trace.joints[shown][:, 5], color="#bf4033")
    axes[3].set_ylabel("leg retraction (mm)")
    axes[3].set_xlabel("time (s)")
    colours = {"shift": "#dddddd", "lift": "#ffe08a", "land": "#bfe3c0"}
    phases = trace.phase[shown]
    for axis in axes:
        for begin, end, phase in zip(time[:-1], time[1:], phases[:-1], strict=True):
            axis.axvspan(begin, end, color=colours[phase], linewidth=0)
    axes[0].set_title("one gait cycle: shift (grey), lift (yellow), land (green)")
    figure.tight_layout()
    figure.savefig(HERE / "gait_cycle.png", dpi=100)


if __name__ == "__main__":
    main()
