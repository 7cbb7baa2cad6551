"""The kinds of what is recorded, and the files that tell them apart."""

from sarah.recorded.kind import Kind

TRAINING = Kind("training", "run folder", "config.yaml", "sarah-train")
SESSION = Kind("session", "session folder", "session.yaml", "sarah-operate")
RECOGNITION = Kind("recognition", "recognition folder", "recognition.json", "sarah-train --offline")
