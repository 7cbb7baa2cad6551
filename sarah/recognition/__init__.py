"""What logs of robots teach: which robot one is by what it feels, and which parameters are known for it.

It may import runs, logs and what these may import, and no learner.
"""
