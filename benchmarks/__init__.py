"""Timings of the package, and nothing else: what tests cannot say, because machines differ."""
