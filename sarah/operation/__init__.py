"""A robot that goes on: windows in which it is measured, a reward that its own sensors give, falls and changes.

It may import episode and what that may import.
"""
