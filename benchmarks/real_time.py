"""How late are the ticks of sarah-robot, and what does a tick of its controller cost?

A bare loop that only sleeps to the same deadlines runs in turn with it, in the same process. A tick is late if it
begins more than 2 ms after its deadline.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

from pandas import DataFrame

from benchmarks.timing import Timing
from experiments.record import Row
from experiments.tables import table
