"""A robot that steps, reached from outside: new parameters, standing and stepping, and telemetry (extra ``remote``).

It may import drivers, operation and what those may import.
"""
