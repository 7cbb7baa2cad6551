"""Colours with a meaning, the same in all pictures, which colour-blind people can tell apart (Okabe and Ito)."""

from __future__ import annotations

LEFT, RIGHT = "#0072B2", "#D55E00"
"""Colours of the legs, as in the robot's visual shapes."""
PHASE_COLOURS = {"shift": "#AEB6C2", "lift": "#F2C14E", "land": "#7CC6A4"}
"""Colours of the pattern generator's phases."""
PUSH = "#8C2B8F"
"""Colour of a push."""
