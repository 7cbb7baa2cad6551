"""``python -m tests.endurance NAME``: run an endurance test; without a name, list all of them with their questions."""

from experiments.command import run
from experiments.found import ENDURANCE

if __name__ == "__main__":
    run(ENDURANCE)
