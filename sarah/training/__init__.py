"""Trainings: agents of stable-baselines3 and black-box optimisers at work on a task.

It may import agents, envs, runs, pictures and what they may import.
"""
