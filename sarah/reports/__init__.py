"""What comes of trainings: the paper's figures, reports, races, robustness and transfer.

It may import training and viewer, and what they may import.
"""
