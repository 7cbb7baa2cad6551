"""The same parameters in PyBullet and in MuJoCo, side by side.

One sees that both engines agree within a few per cent: what works in one is no artefact of it.
"""

import sarah

METRICS = ("score", "steps_per_second", "sole_clearance", "actuator_power")
PARAMETERS = (0.4, 1.3, 0.1, 1.0, 1.0)
evaluations = {}
for engine in ("pybullet", "mujoco"):
    config = sarah.EpisodeConfig(engine=engine, time_limit=10.0)
    evaluations[engine] = sarah.evaluate("stepping", PARAMETERS, config, seeds=range(3))
print(" " * 18 + "".join(f"{engine:>10}" for engine in evaluations))
for metric in METRICS:
    means = (evaluation.mean(metric) for evaluation in evaluations.values())
    print(f"{metric:18}" + "".join(f"{mean:10.3f}" for mean in means))
