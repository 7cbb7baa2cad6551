"""The same push, met with locked hips and with the hip law.

One sees that the robot with locked hips leaves its place, and that the other one steps on until the time limit.
"""

import sarah

push = sarah.Push(newtons=(100.0, 100.0), degrees=(90.0, 90.0), at_seconds=(2.0, 2.0))  # from behind
config = sarah.BalanceConfig(push=push, time_limit=10.0)
for name, parameters in {"locked hips": (0.0, 0.0, 0.0, 0.0), "V1 = 0.8": (0.8, 0.0, 0.0, 0.0)}.items():
    result = sarah.simulate(sarah.EpisodeSpec(parameters, seed=1, task="balance", config=config))
    print(
        f"{name:12} {result.duration:5.2f} s, ended by {result.termination}, {100 * result.drift:.0f} cm off its place"
    )
