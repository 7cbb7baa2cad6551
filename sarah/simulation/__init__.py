"""The robot in a physics engine: PyBullet or MuJoCo behind one protocol, imperfect sensors, and pictures of the robot.

It may import errors, files, robot and scenery; it alone imports an engine.
"""
