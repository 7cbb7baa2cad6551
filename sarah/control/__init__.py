"""The controller that runs on a robot: pattern generator and hip law, in plain floats.

It may import errors and robot; no numpy and no physics engine.
"""
