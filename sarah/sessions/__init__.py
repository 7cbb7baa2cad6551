"""Learners of sessions."""
