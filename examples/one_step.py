"""One step of an agent is one episode of the robot: here with P1 to P5 as the paper has them.

One sees every metric of the episode, and how it ended: the robot steps in place for 30 s.
"""

import sarah

spec = sarah.EpisodeSpec(parameters=(0.4, 1.3, 0.1, 1.0, 1.0), seed=0, task="stepping")
result = sarah.simulate(spec)
for name, value in result.fields().items():
    print(f"{name:18} {value}")
