"""The robot in a physics engine: PyBullet or MuJoCo behind one protocol, imperfect sensors, pictures of it.

It may import errors, files and robot; it alone imports an engine.
"""
