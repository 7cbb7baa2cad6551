"""The kinds of what is recorded, and the files that tell them apart."""

from sarah.recorded.folder import Kind

TRAINING = Kind("training", "config.yaml", "sarah-train")
SESSION = Kind("session", "session.yaml", "sarah-operate")
