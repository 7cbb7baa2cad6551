"""How an episode ends: the paper's three criteria, a fall, and a simulation that diverges."""

from __future__ import annotations

import math

BOX_HALF_WIDTH = 0.25
"""Displacement of the torso along any axis at which an episode ends, in m; the paper's second criterion."""
OSCILLATION_SECONDS = 5.0
"""Simulated time by which the robot must oscillate, in s; the paper's third criterion."""
OSCILLATION_STEPS = 2
"""Steps that count as an oscillation: one with each leg."""
LEAST_UPRIGHT = math.cos(math.radians(45.0))
"""Cosine of the torso's tilt beyond which the robot has fallen."""
TERMINATIONS = ("time_limit", "left_box", "no_oscillation", "fell", "diverged")
"""How an episode can end: the paper's three criteria, a tilt beyond 45 degrees, and a state or signal that is no
number or beyond all bounds."""
ENDINGS = {
    "time_limit": "ran to the end",
    "left_box": "left its place",
    "no_oscillation": "did not step",
    "fell": "fell",
    "diverged": "diverged",
}
"""What pages and lists say of each of :data:`TERMINATIONS`."""
