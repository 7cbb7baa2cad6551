"""What a robot did, in a file that other programs open: written beside the control loop, read, summarised and played.

It may import operation and what that may import.
"""
