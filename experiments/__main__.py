"""``python -m experiments NAME``: make a result; without a name, list all of them with their questions."""

from experiments.command import run
from experiments.found import EXPERIMENTS

if __name__ == "__main__":
    run(EXPERIMENTS)
