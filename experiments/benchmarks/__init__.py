"""Timings: how fast simulation, workers, learner and viewer are."""
