"""``python -m benchmarks NAME``: time something; without a name, list all timings with their questions."""

from experiments.command import run
from experiments.found import BENCHMARKS

if __name__ == "__main__":
    run(BENCHMARKS)
