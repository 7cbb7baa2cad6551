"""An algorithm of your own: a hill climber in a loop of ten lines.

One sees every improvement of the score. The climber changes the best parameters so far a little, and keeps the change
if the same two episodes then score more.
"""

import random

import sarah
from sarah.episode.tasks import STEPPING

config = sarah.EpisodeConfig(time_limit=5.0)
generator = random.Random(0)
best, best_score = STEPPING.box.checked([1.0] * 5), 0.0
for attempt in range(20):
    tried = STEPPING.box.clipped(generator.gauss(value, 0.3) for value in best)
    score = sarah.evaluate("stepping", tried, config, seeds=range(2)).median("score")
    if score > best_score:
        best, best_score = tried, score
        values = ", ".join(f"{value:.2f}" for value in best)
        print(f"attempt {attempt:2}: score {score:.3f} with P = {values}")
