"""A training's settings and its run folder: everything that is written to disk and read back.

It may import episode and what that may import, but no learning algorithm.
"""
