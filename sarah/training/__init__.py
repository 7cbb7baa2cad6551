"""Trainings: agents of stable-baselines3, and black-box optimisers, learn the parameters of a task.

It may import agents, envs, runs, pictures and what those may import.
"""
