"""The same push from behind, met with locked hips and with the hip law.

One sees that the robot with locked hips leaves its place, and that the other one steps on until the time limit.
"""

import sarah

push = sarah.Push(newtons=(100.0, 100.0), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0))
config = sarah.BalanceConfig(push=push, time_limit=10.0)
for v1 in (0.0, 0.8):  # 0 locks the hips
    spec = sarah.EpisodeSpec((v1, 0.0, 0.0, 0.0), seed=1, task="balance", config=config)
    result = sarah.simulate(spec)
    end = f"{result.termination} after {result.duration:.1f} s"
    print(f"V1 = {v1}: {end}, {100 * result.drift:.0f} cm away")
