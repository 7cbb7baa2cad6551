"""Experiments about NAF: on tasks of others, and against other algorithms."""
