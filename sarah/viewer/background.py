"""Simulation beside the page, in a thread; a new request replaces the one before it."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import NamedTuple

from sarah.episode.episode import Episode
from sarah.episode.result import EpisodeResult
from sarah.episode.spec import EpisodeSpec
from sarah.errors import SarahError

TICKS_BETWEEN_LOOKS = 50
"""Number of control ticks after which progress is reported, and a newer request is noticed."""


class Wish(NamedTuple):
    """A request to simulate an episode.

    :param spec: specification of the episode
    :param done: function that is called with the result, which has a trace
    :param recorded: function that simulates it, if it is more than its specification says
    """

    spec: EpisodeSpec
    done: Callable[[EpisodeResult], None]
    recorded: Callable[[], EpisodeResult] | None = None


class BackgroundSimulation:
    """Simulates one episode at a time, in a thread of its own.

    :param progress: function that is called with the simulated share of the episode, from 0 to 1
    :param failed: function that is called with one line that says why an episode cannot be simulated
    """

    def __init__(self, progress: Callable[[float], None], failed: Callable[[str], None]) -> None:
        self._progress = progress
        self._failed = failed
        self._wish: Wish | None = None
        self._condition = threading.Condition()
        threading.Thread(target=self._run, name="simulation", daemon=True).start()

    def request(self, wish: Wish) -> None:
        """Simulate an episode; an episode that is being simulated is abandoned.

        :param wish: request for the episode
        """
        with self._condition:
            self._wish = wish
            self._condition.notify()

    def _run(self) -> None:
        while True:
            with self._condition:
                self._condition.wait_for(lambda: self._wish is not None)
                wish, self._wish = self._wish, None
            assert wish is not None
            try:
                result = self._simulate(wish.spec) if wish.recorded is None else wish.recorded()
            except SarahError as error:
                self._failed(str(error))
                continue
            if result is not None:
                wish.done(result)

    def _simulate(self, spec: EpisodeSpec) -> EpisodeResult | None:
        """Simulate an episode; return ``None`` if there is a newer request."""
        with Episode.of(spec, record_trace=True) as episode:
            episode.stand()
            episode.start(spec.parameters)
            ticks = 0
            while episode.termination is None:
                episode.tick()
                ticks += 1
                if ticks % TICKS_BETWEEN_LOOKS == 0:
                    if self._wish is not None:
                        return None
                    self._progress(episode.robot.simulation.time / spec.config.time_limit)
            return episode.result()
