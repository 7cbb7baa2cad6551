"""One episode as a pure function of its specification, and workers that simulate many episodes.

It may import errors, files, versions, robot, scenery, control and simulation.
"""
