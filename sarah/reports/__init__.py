"""Reports of trainings: the paper's figures, HTML pages, races, robustness and transfer.

It may import training and viewer, and what those may import.
"""
