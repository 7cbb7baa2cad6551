"""Colours with a meaning, the same in every picture and plot; the colour-blind tell them apart (Okabe and Ito)."""

from __future__ import annotations

LEFT, RIGHT = "#0072B2", "#D55E00"
"""Of the legs, as in the robot's visual shapes."""
PHASE_COLOURS = {"shift": "#AEB6C2", "lift": "#F2C14E", "land": "#7CC6A4"}
"""Of the pattern generator's phases."""
PUSH = "#8C2B8F"
"""Of a push."""
