"""The paper's Figure 3: the pattern generator's state machine and the hip law, with the constants of a controller."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.pattern_generator import STAND_SECONDS, Phase
from sarah.pictures.colours import PHASE_COLOURS
from sarah.pictures.style import COLUMN_WIDTH, own_style, save, times

NOTE = """tilt (m/s²), rate (rad/s): low-passed lateral acceleration and angular rate
about y, towards the stance leg, plus {tilt:g} and {rate:g} times the abduction
(without V2) and its rate. stable_x (m/s²): slower low-pass of the lateral
acceleration. All signals without slow baselines. fall, lean (rad): of the leg
that carries, where it is going. Every phase lasts at least {shortest:g} s."""


@dataclass(frozen=True)
class PhaseFacts:
    """A phase of the pattern generator, and what ends it.

    :param phase: phase of the generator
    :param condition: sensor condition that ends it
    :param time_out: formula of the time in s after which it ends otherwise
    :param swing_length: target of the swing leg's length, in m, positive when retracted; the stance leg is straight
    """

    phase: Phase
    condition: str
    time_out: str
    swing_length: float


def phases(constants: ControllerConstants = STANDARD_CONSTANTS) -> tuple[PhaseFacts, PhaseFacts, PhaseFacts]:
    """The phases of a step, in their order.

    :param constants: constants of the controller
    """
    seconds = f"{constants.time_out_seconds:g}"
    over_stance = f"tilt > P2 and rate > {times(constants.rate_scale, 'P3')} and stance foot loaded"
    return (
        PhaseFacts(Phase.SHIFT, over_stance, f"{seconds} (1 + P5)", -constants.shift_extension),
        PhaseFacts(
            Phase.LIFT,
            f"rate < {times(-constants.landing_rate, 'P1')}",
            f"{seconds} (1 + P4)",
            constants.lift_retraction,
        ),
        PhaseFacts(Phase.LAND, "swing foot loaded", f"{seconds} (1 + P5)", 0.0),
    )


def hip_law(constants: ControllerConstants = STANDARD_CONSTANTS) -> dict[str, str]:
    """Formulas of the hip targets, by what they are for.

    :param constants: constants of the controller
    """
    constant = f"{constants.flexion_scale:g} V4"
    return {
        "abduction of both hips": f"\u2212{constants.abduction_scale:g} (V1 stable_x + V2)",
        "and outward": f"{constants.spread_gain:g} V1 (outward lean beyond {constants.spread_dead_band:g})",
        "flexion of an unloaded leg": f"\u2212{constants.capture_gain:g} V3 fall + {constant}",
        "flexion of a loaded leg": constant,
    }


def draw_state_machine(path: Path, constants: ControllerConstants = STANDARD_CONSTANTS) -> list[Path]:
    """Draw the state machine: actions in white boxes, and the conditions that end a phase in coloured ones.

    :param path: path of the picture, without suffix
    :param constants: constants of the controller
    :return: the files, PNG and PDF
    """
    with own_style():
        figure = plt.figure(figsize=(COLUMN_WIDTH, 5.4))
        axis = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axis.axis("off")
        axis.set(xlim=(0.0, 10.0), ylim=(0.4, 18.1))
        y = _box(axis, 17.9, f"STAND\nfor {STAND_SECONDS:g} s", "white")
        top = 0.0
        for facts in phases(constants):
            _arrow(axis, y, y - 0.5)
            top = top or y - 0.5
            action = f"{facts.phase.name}\nswing leg {_motion(facts.swing_length)}, stance leg straight"
            y = _box(axis, y - 0.5, action, "white")
            _arrow(axis, y, y - 0.5)
            y = _box(axis, y - 0.5, f"{facts.condition}\nor after {facts.time_out} s", PHASE_COLOURS[facts.phase.value])
        middle = y + 0.65
        axis.plot([8.8, 9.3, 9.3], [middle, middle, top - 0.65], color="black", linewidth=0.8)
        axis.annotate(
            "", (8.8, top - 0.65), (9.3, top - 0.65), arrowprops={"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0}
        )
        axis.text(9.4, (middle + top) / 2, "legs swap", rotation=90, va="center", fontsize=7)
        laws = [f"{name}: {formula}" for name, formula in hip_law(constants).items()]
        limits = f"within ±{constants.largest_hip_angle:g} rad, at {constants.hip_speed:g} rad/s"
        _box(axis, y - 0.5, "\n".join(["Second Training, at every tick", *laws, limits]), "white", height=2.9)
        tilt, rate = constants.abduction_tilt, constants.abduction_rate_share
        note = NOTE.format(tilt=tilt, rate=rate, shortest=constants.minimum_phase_seconds)
        axis.text(0.2, y - 3.6, note, va="top", fontsize=6)
        return save(figure, path)


def _motion(length: float) -> str:
    """Words for what a leg does."""
    if length == 0.0:
        return "straight"
    return f"{'retracts' if length > 0 else 'pushes'} by {1000 * abs(length):.3g} mm"


def _box(axis: Axes, top: float, text: str, colour: str, height: float = 1.3) -> float:
    """Draw a box with its text, and return its lower edge; the first line in a white box is bold."""
    left, width = 0.2, 8.6
    axis.add_patch(
        plt.Rectangle((left, top - height), width, height, facecolor=colour, edgecolor="black", linewidth=0.8)
    )
    lines = text.split("\n")
    for index, line in enumerate(lines):
        y = top - height * (index + 0.5 + 0.15) / (len(lines) + 0.3)
        weight = "bold" if index == 0 and colour == "white" else "normal"
        axis.text(left + width / 2, y, line, ha="center", va="center", fontsize=7, fontweight=weight)
    return top - height


def _arrow(axis: Axes, begin: float, end: float) -> None:
    axis.annotate("", (4.5, end), (4.5, begin), arrowprops={"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0})
