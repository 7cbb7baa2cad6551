"""Episodes and operations as environments of gymnasium, and one of stable-baselines3 with many episodes in flight.

It may import operation, episode and what these may import.
"""
