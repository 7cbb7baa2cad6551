"""Episodes as environments: one of gymnasium, and one of stable-baselines3 with many episodes in flight.

It may import episode and what that may import.
"""
