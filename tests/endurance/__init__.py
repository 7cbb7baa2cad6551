"""Kills, faults and long runs: what holds for minutes to hours, and is no part of ``make test``.

A case that does not hold ends the command with an error. So a result has only cases that held.
"""
