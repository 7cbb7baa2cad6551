"""Plots, drawings and videos of the robot and of its episodes.

It may import episode and what that may import.
"""
