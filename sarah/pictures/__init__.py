"""Plots, drawings and videos of the robot and of its episodes.

It may import operation, episode and what these may import.
"""
