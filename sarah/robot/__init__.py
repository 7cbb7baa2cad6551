"""The robot itself: its description as a checked URDF, what it senses, and filters for that.

It may import errors.
"""
