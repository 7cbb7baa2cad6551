"""Sessions: a robot in operation whose parameters a learner renews, from what the robot itself feels."""
