"""The robot's surroundings: the ground, and what a camera sees of it, drawn without an engine.

It may import errors and robot.
"""
