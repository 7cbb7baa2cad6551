"""NAF for stable-baselines3: the algorithm, a variant for tasks of one step, policies and replay buffers."""

from sarah.agents.buffers import RankReplayBuffer
from sarah.agents.local_naf import LocalNAF
from sarah.agents.naf import NAF
from sarah.agents.policies import CnnPolicy, MlpPolicy, MultiInputPolicy
from sarah.agents.presets import PRESETS
from sarah.agents.smoothed_buffer import SmoothedReplayBuffer

__all__ = [
    "NAF",
    "PRESETS",
    "CnnPolicy",
    "LocalNAF",
    "MlpPolicy",
    "MultiInputPolicy",
    "RankReplayBuffer",
    "SmoothedReplayBuffer",
]
