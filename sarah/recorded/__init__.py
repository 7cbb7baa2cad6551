"""What is recorded: deterministic programs that ask, a journal that answers what it knows, and the folder of both.

It knows nothing of robots, and may import errors, files and versions.
"""
