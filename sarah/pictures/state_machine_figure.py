"""The paper's Figure 3: the pattern generator's state machine and the hip law, drawn from the running code.

The figure repeats nothing by hand. The conditions come from evaluating the generator's own condition with names in
place of numbers. Phases, their order, time-outs and leg lengths come from running the generator.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from sarah.control.constants import STANDARD_CONSTANTS, ControllerConstants
from sarah.control.hip_law import BalanceParameters, HipLaw
from sarah.control.pattern_generator import (
    STAND_SECONDS,
    PatternGenerator,
    Phase,
    SteppingParameters,
)
from sarah.pictures.colours import PHASE_COLOURS
from sarah.pictures.style import COLUMN_WIDTH, STYLE, save
from sarah.robot.reading import SensorReading, Side

SILENCE = SensorReading((0.0, 0.0, 9.81), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0), (0.0,) * 6)
"""Reading with which no sensor condition ends a phase."""
DT = 0.001
MINUS = "\u2212"
NOTE = """tilt (m/s²), rate (rad/s): low-passed lateral acceleration and angular rate
about y, towards the stance leg, plus {tilt:g} and {rate:g} times the abduction
(without V2) and its rate. stable_x (m/s²): slower low-pass of the lateral
acceleration. All signals without slow baselines. fall (rad): lean of the leg
that carries, where it is going. Every phase lasts at least {shortest:g} s."""


class Name:
    """A quantity without a value: arithmetic writes a formula, and a comparison is recorded and true.

    :param text: formula of the quantity
    :param noted: list that records the comparisons
    """

    def __init__(self, text: str, noted: list[str]) -> None:
        self.text = text
        self._noted = noted

    def __mul__(self, other: Any) -> Name:
        """Write a product, with numbers first."""
        first, second = (self, other) if isinstance(other, Name) else (other, self)
        return Name(f"{_text(first, True)} {_text(second, True)}", self._noted)

    def __rmul__(self, other: Any) -> Name:
        """Write a product with a number."""
        return self * other

    def __add__(self, other: Any) -> Name:
        """Write a sum."""
        return Name(f"{self.text} + {_text(other)}", self._noted)

    def __neg__(self) -> Name:
        """Write the negative."""
        return Name(f"{MINUS}{_text(self, True)}", self._noted)

    def __gt__(self, other: Any) -> bool:
        """Record that this must be larger."""
        self._noted.append(f"{self.text} > {_text(other)}")
        return True

    def __lt__(self, other: Any) -> bool:
        """Record that this must be smaller."""
        self._noted.append(f"{self.text} < {_text(other)}")
        return True


def _text(value: Any, is_factor: bool = False) -> str:
    text = value.text if isinstance(value, Name) else f"{value:g}".replace("-", MINUS)
    return f"({text})" if is_factor and "+" in text else text


@dataclass(frozen=True)
class PhaseFacts:
    """A phase of the pattern generator, and the conditions that end it.

    :param phase: phase of the generator
    :param following: phase after it
    :param swaps_legs: whether the other leg swings after it
    :param conditions: sensor conditions that together end it
    :param time_out: formula of the time-out in s, which ends it otherwise
    :param swing_length: target of the swing leg's length, in m, positive when retracted
    :param stance_length: target of the stance leg's length, in m, positive when retracted
    """

    phase: Phase
    following: Phase
    swaps_legs: bool
    conditions: tuple[str, ...]
    time_out: str
    swing_length: float
    stance_length: float


def read_state_machine(constants: ControllerConstants = STANDARD_CONSTANTS) -> list[PhaseFacts]:
    """Extract the phases from the pattern generator.

    :param constants: constants of the controller
    :return: all phases but STAND, in their order
    """
    observed = _observe(0.0, 0.0, constants)
    stretched = {"P4": _observe(1.0, 0.0, constants), "P5": _observe(0.0, 1.0, constants)}
    facts = []
    for index, (phase, duration, lengths, swing) in enumerate(observed[:-1]):
        time_out = f"{duration:g}"
        for name, other in stretched.items():
            share = round(other[index][1] / duration - 1.0, 6)
            if share:
                time_out += f" (1 + {name})" if share == 1.0 else f" (1 + {share:g} {name})"
        following, _, _, next_swing = observed[index + 1]
        facts.append(
            PhaseFacts(
                phase,
                following,
                next_swing is not swing,
                _conditions(phase, constants),
                time_out,
                lengths[swing],
                lengths[swing.other],
            )
        )
    return facts


def _observe(
    p4: float, p5: float, constants: ControllerConstants
) -> list[tuple[Phase, float, dict[Side, float], Side]]:
    """Phase, duration in s, final leg lengths in m, swing leg: for one step without sensors and the phase after it."""
    generator = PatternGenerator(SteppingParameters(1.0, 1.0, 1.0, p4, p5), dt=DT, constants=constants)
    while generator.phase is Phase.STAND:
        generator.tick(SILENCE)
    seen: list[tuple[Phase, float, dict[Side, float], Side]] = []
    while len(seen) < 4:
        phase, swing, ticks = generator.phase, generator.swing, 0
        lengths: dict[Side, float] = {}
        while generator.phase is phase:
            lengths = dict(zip(Side, generator.targets[4:], strict=True))
            generator.tick(SILENCE)
            ticks += 1
        seen.append((phase, round(ticks * DT, 3), lengths, swing))
    return seen


def _conditions(phase: Phase, constants: ControllerConstants) -> tuple[str, ...]:
    """Sensor conditions that end a phase."""
    noted: list[str] = []
    parameters = SteppingParameters(*(Name(name, noted) for name in SteppingParameters.__dataclass_fields__))  # type: ignore[arg-type]

    def is_loaded(foot: str) -> bool:
        noted.append(f"{foot} foot loaded")
        return True

    stand_in: Any = SimpleNamespace(
        phase=phase,
        parameters=parameters,
        constants=constants,
        tilt=Name("tilt", noted),
        rate=Name("rate", noted),
        stance="stance",
        swing="swing",
        _is_loaded=is_loaded,
    )
    PatternGenerator._condition_holds(stand_in)
    return tuple(noted)


def read_hip_law(constants: ControllerConstants = STANDARD_CONSTANTS) -> dict[str, str]:
    """Extract the formulas from the hip law.

    :param constants: constants of the controller
    :return: formulas of the hip targets, by name of the target
    """
    noted: list[str] = []
    parameters = BalanceParameters(*(Name(name, noted) for name in BalanceParameters.__dataclass_fields__))  # type: ignore[arg-type]
    stand_in: Any = SimpleNamespace(
        parameters=parameters,
        _constants=constants,
        stable_x=Name("stable_x", noted),
        fall=Name("fall", noted),
        _constant_flexion=constants.flexion_scale * parameters.V4,
        loads={Side.LEFT: 0.0, Side.RIGHT: math.inf},
    )
    abduction: Any
    flexion: Any
    abduction, flexion = HipLaw._wanted(stand_in)
    return {
        "abduction of both hips": abduction.text,
        "flexion of an unloaded leg": flexion[Side.LEFT].text,
        "flexion of a loaded leg": flexion[Side.RIGHT].text,
    }


def draw_state_machine(path: Path, constants: ControllerConstants = STANDARD_CONSTANTS) -> list[Path]:
    """Draw the state machine: actions in white boxes, and the conditions that end a phase in coloured ones.

    :param path: path of the picture, without suffix
    :param constants: constants of the controller
    :return: the files, PNG and PDF
    """
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(COLUMN_WIDTH, 5.4))
        axis = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axis.axis("off")
        axis.set(xlim=(0.0, 10.0), ylim=(0.8, 18.1))
        y = _box(axis, 17.9, f"STAND\nfor {STAND_SECONDS:g} s", "white")
        machine = read_state_machine(constants)
        top = 0.0
        for facts in machine:
            _arrow(axis, y, y - 0.5)
            top = top or y - 0.5
            action = f"{facts.phase.name}\n{_leg('swing', facts.swing_length)}, {_leg('stance', facts.stance_length)}"
            y = _box(axis, y - 0.5, action, "white")
            _arrow(axis, y, y - 0.5)
            condition = f"{' and '.join(facts.conditions)}\nor after {facts.time_out} s"
            y = _box(axis, y - 0.5, condition, PHASE_COLOURS[facts.phase.value])
        assert machine[-1].following is machine[0].phase
        middle = y + 0.65
        axis.plot([8.8, 9.3, 9.3], [middle, middle, top - 0.65], color="black", linewidth=0.8)
        axis.annotate(
            "", (8.8, top - 0.65), (9.3, top - 0.65), arrowprops={"arrowstyle": "->", "shrinkA": 0, "shrinkB": 0}
        )
        if machine[-1].swaps_legs:
            axis.text(9.4, (middle + top) / 2, "legs swap", rotation=90, va="center", fontsize=7)
        laws = [f"{name}: {formula}" for name, formula in read_hip_law(constants).items()]
        limits = f"within ±{constants.largest_hip_angle:g} rad, at {constants.hip_speed:g} rad/s"
        _box(axis, y - 0.5, "\n".join(["Second Training, at every tick", *laws, limits]), "white", height=2.5)
        tilt, rate = constants.abduction_tilt, constants.abduction_rate_share
        note = NOTE.format(tilt=tilt, rate=rate, shortest=constants.minimum_phase_seconds)
        axis.text(0.2, y - 3.2, note, va="top", fontsize=6)
        return save(figure, path)


def _leg(name: str, length: float) -> str:
    """Words for the motion of a leg."""
    millimetres = round(1000 * abs(length))
    how = f"retracts by {millimetres} mm" if length > 0 else f"pushes by {millimetres} mm" if length < 0 else "straight"
    return f"{name} leg {how}"


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
