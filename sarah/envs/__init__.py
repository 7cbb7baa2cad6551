"""Episodes as environments: of gymnasium, and of stable-baselines3 with many in flight.

It may import episode and what it may import.
"""
