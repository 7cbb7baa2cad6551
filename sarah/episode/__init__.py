"""One episode as a pure function of its specification, and the workers that simulate many.

It may import errors, files, versions, robot, control and simulation.
"""
