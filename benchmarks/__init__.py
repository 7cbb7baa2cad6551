"""Timings: how fast simulation, workers, learner and viewer are, as results of :mod:`experiments`."""
