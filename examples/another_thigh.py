"""The same parameters on robots with other thighs.

One sees each robot's height, and its score. ``default_dimensions`` names everything that can be changed.
"""

import sarah
from sarah.robot.description import describe_robot
from sarah.robot.dimensions import default_dimensions

default = default_dimensions()["thigh_length"]
for thigh in (default - 0.05, default, default + 0.05):
    dimensions = {"thigh_length": thigh}
    config = sarah.EpisodeConfig(dimensions=dimensions, time_limit=10.0)
    spec = sarah.EpisodeSpec((0.4, 1.3, 0.1, 1.0, 1.0), seed=0, config=config)
    result = sarah.simulate(spec)
    height = describe_robot(dimensions).standing_height
    print(f"thigh {thigh:.2f} m, torso at {height:.2f} m: score {result.score:.3f}")
