"""NAF for stable-baselines3: the algorithm, its policies and a replay buffer for tasks of one step."""

from sarah.agents.buffers import RankReplayBuffer
from sarah.agents.naf import NAF, PRESETS
from sarah.agents.policies import CnnPolicy, MlpPolicy, MultiInputPolicy

__all__ = ["NAF", "PRESETS", "CnnPolicy", "MlpPolicy", "MultiInputPolicy", "RankReplayBuffer"]
