"""The same push from behind, met with locked hips and with the hip law.

One sees that the robot with locked hips leaves its place, and that the other one steps on until the time limit.
"""

import sarah

push = sarah.Push(newtons=(115.0, 115.0), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0))
config = sarah.BalanceConfig(push=push, time_limit=10.0)
for gain in (0.0, 1.0):  # of V1 and V3; 0 locks the hips
    spec = sarah.EpisodeSpec((gain, 0.0, gain, 0.0), seed=1, task="balance", config=config)
    result = sarah.simulate(spec)
    end = f"{result.termination} after {result.duration:.1f} s"
    print(f"V1 = V3 = {gain}: {end}, {100 * result.drift:.0f} cm away")
