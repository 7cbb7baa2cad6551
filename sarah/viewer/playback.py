"""The clock that plays episodes."""

from __future__ import annotations

import threading
import time as clock
from collections.abc import Callable

FRAMES_PER_SECOND = 30


class Playback:
    """Plays a span of simulated time, in a thread of its own.

    :param show: function that is called for each frame with its simulated time, in s
    :param ended: function that is called after the last frame, if the clock ran to it
    """

    def __init__(self, show: Callable[[float], None], ended: Callable[[], None] = lambda: None) -> None:
        self.time = 0.0
        self.speed = 1.0
        self.is_playing = False
        self._show = show
        self._ended = ended
        self._begin = self._end = 0.0
        self._needs_frame = False
        self._lock = threading.RLock()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="playback", daemon=True)

    def start(self) -> None:
        """Begin to show frames."""
        self._thread.start()

    def close(self) -> None:
        """Stop showing frames."""
        self._stop.set()

    def load(self, begin: float, end: float, time: float) -> None:
        """Play another span of time.

        :param begin: simulated time at which it begins, in s
        :param end: simulated time at which it ends, in s
        :param time: simulated time to go on from, in s
        """
        with self._lock:
            self._begin, self._end = begin, end
            self.seek(time)

    def seek(self, time: float) -> None:
        """Go to a time.

        :param time: simulated time, in s; a time outside the span becomes its nearer end
        """
        with self._lock:
            self.time = min(max(time, self._begin), self._end)
            self._needs_frame = True

    def play(self) -> None:
        """Play on, or from the beginning if the end has been reached."""
        with self._lock:
            if self.time >= self._end:
                self.seek(self._begin)
            self.is_playing = self._needs_frame = True

    def pause(self) -> None:
        """Stop the clock."""
        with self._lock:
            self.is_playing, self._needs_frame = False, True

    def _run(self) -> None:
        last = due = clock.perf_counter()
        while not self._stop.wait(max(0.0, due - clock.perf_counter())):
            now = clock.perf_counter()
            due = max(due + 1.0 / FRAMES_PER_SECOND, now - 1.0 / FRAMES_PER_SECOND)  # one late frame is caught up
            with self._lock:
                was_playing = self.is_playing
                self._advance(now - last)
                has_ended = was_playing and not self.is_playing
                frame = self.time if self._needs_frame else None
                self._needs_frame = False
            last = now
            if frame is not None:
                self._show(frame)
            if has_ended:
                self._ended()

    def _advance(self, seconds: float) -> None:
        if not self.is_playing:
            return
        self.seek(self.time + seconds * self.speed)
        self.is_playing = self.time < self._end
