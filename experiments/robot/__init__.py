"""Experiments about the robot: what it learns, what it can do, and what the simulation is worth."""
