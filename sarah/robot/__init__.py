"""The robot itself: its description as a checked URDF, its sensor readings, and filters for them.

It may import errors.
"""
