"""Kills, faults and long runs: what holds for minutes to hours, run by ``make endurance``."""
