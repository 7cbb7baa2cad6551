"""The page: choose an episode, play it, and change its parameters, seed and push."""

from __future__ import annotations

import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import viser

from sarah.episode.push import NO_PUSH, Push
from sarah.episode.result import EpisodeResult
from sarah.episode.robot_settings import conditions_of
from sarah.episode.spec import EpisodeSpec
from sarah.episode.tasks import BALANCE, STEPPING, Task
from sarah.robot.reading import Side
from sarah.runs.episode_words import told_settings
from sarah.runs.run_episodes import RunEpisode
from sarah.viewer.background import BackgroundSimulation, Wish
from sarah.viewer.playback import Playback
from sarah.viewer.plots import Plots
from sarah.viewer.results import comparison, paragraph
from sarah.viewer.scenario import Scenario
from sarah.viewer.scene import RobotScene, describe_tick

SPEEDS = {"1/10": 0.1, "1/4": 0.25, "1/2": 0.5, "1": 1.0, "2": 2.0, "4": 4.0}
SECONDS_BEFORE_PUSH = 0.5
"""Time before a push from which the page plays on when the push is added, in s."""
LARGEST_SLOPE, HIGHEST_BUMPS, LARGEST_FRICTION = 15.0, 30.0, 1.5
"""Usual upper ends of the ground's sliders: degrees, mm, and a coefficient."""
LARGEST_PUSH = 200.0
"""Usual upper end of the force's slider, in N."""


class Page:
    """The page of a set of episodes. Everyone who opens it sees, and steers, the same page.

    :attr:`frames` counts the frames since the beginning.

    :param server: server of the page
    :param choices: episodes to choose from
    :param chosen: episode that is shown first
    """

    def __init__(self, server: viser.ViserServer, choices: Sequence[RunEpisode], chosen: RunEpisode) -> None:
        self._choices = {choice.label: choice for choice in choices}
        self._chosen = chosen
        self._wanted = Scenario.of(chosen.spec)
        self._shown: EpisodeResult | None = None
        self._lock = threading.RLock()
        self._is_seen = False
        self.frames = 0
        self._playback = Playback(self._show, self._play_on)
        self._scene = RobotScene(server, chosen.spec.robot)
        self._plots = Plots(server.gui)
        self._gui = server.gui
        self._gui.main_panel.dock_right()
        self._gui.main_panel.set_width(340)
        self._simulation = BackgroundSimulation(self._show_progress, self._show_failure)
        self._build()
        self._playback.start()
        self._play_choice(chosen)
        server.on_client_connect(lambda _: self.begin())

    def begin(self) -> None:
        """Begin to play, once somebody has opened the page: nobody is to miss the push."""
        with self._lock:
            is_waiting, self._is_seen = self._shown is not None and not self._is_seen, True
        if is_waiting:
            self._playback.play()

    def close(self) -> None:
        """Stop showing frames."""
        self._playback.close()

    # -- the elements of the page, from top to bottom

    def _build(self) -> None:
        gui = self._gui
        self._status = gui.add_html(paragraph("", ""))
        with gui.add_folder("Play"):
            self._time = gui.add_slider("Time (s)", min=1.0, max=30.0, step=0.01, initial_value=1.0)
            self._play_button = gui.add_button("Play")
            self._speed = gui.add_dropdown("Speed", tuple(SPEEDS), initial_value="1", hint="1 is real time")
        with gui.add_folder("Episode"):
            self._choice = gui.add_dropdown("Episode", tuple(self._choices), initial_value=self._chosen.label)
            self._seed = gui.add_number("Seed", 0, min=0, step=1, hint="draws friction, masses, sensor noise and so on")
            self._again = gui.add_button("Back to this episode", hint="undo the changes of the sliders", color="gray")
            self._table = gui.add_html("")
            self._news = gui.add_html("")
        with gui.add_folder("Pattern generator"):
            self._stepping = self._add_sliders(STEPPING)
        with gui.add_folder("Hips"):
            self._balance = self._add_sliders(BALANCE)
        with gui.add_folder("Push"):
            mass = self._chosen.spec.config.scale.mass
            self._newtons = gui.add_slider(
                "Force (N)", min=0.0, max=LARGEST_PUSH * mass, step=5.0 * mass, initial_value=75.0 * mass
            )
            self._degrees = gui.add_slider(
                "Direction (°)", min=0.0, max=360.0, step=5.0, initial_value=0.0, hint="0 right, 90 forward, 180 left"
            )
            self._push_button = gui.add_button("Push now", hint="at the shown time")
            self._no_push_button = gui.add_button("No push", color="gray")
        with gui.add_folder("Ground"):
            self._slope = gui.add_slider("Slope (°)", min=0.0, max=LARGEST_SLOPE, step=0.5, initial_value=0.0)
            self._uphill = gui.add_slider(
                "Uphill (°)", min=0.0, max=360.0, step=5.0, initial_value=0.0, hint="0 right, 90 forward, 180 left"
            )
            self._roughness = gui.add_slider(
                "Bumps (mm)", min=0.0, max=HIGHEST_BUMPS, step=1.0, initial_value=0.0, hint="another seed has others"
            )
            self._friction = gui.add_slider(
                "Friction", min=0.05, max=LARGEST_FRICTION, step=0.05, initial_value=0.9, hint="0.15 is ice"
            )
        self._connect()

    def _add_sliders(self, task: Task) -> list[viser.GuiSliderHandle[float]]:
        return [
            self._gui.add_slider(
                one.name, min=one.low, max=one.high, step=0.01, initial_value=0.0, hint=one.description
            )
            for one in task.parameters
        ]

    def _connect(self) -> None:
        """Connect the inputs with their actions."""
        _on_user(self._time, self._playback.seek)
        _on_user(self._choice, lambda label: self._play_choice(self._choices[label]))
        _on_user(self._seed, lambda seed: self._change({"seed": int(seed)}))
        for sliders, name in ((self._stepping, "stepping"), (self._balance, "balance")):
            for index, slider in enumerate(sliders):
                _on_user(slider, partial(self._change_parameter, name, index))
        _on_user(self._newtons, lambda newtons: self._change_push(newtons=newtons))
        _on_user(self._degrees, lambda degrees: self._change_push(degrees=degrees))
        _on_user(self._slope, lambda degrees: self._change_ground(slope_degrees=degrees))
        _on_user(self._uphill, lambda degrees: self._change_ground(direction_degrees=degrees))
        _on_user(self._roughness, lambda height: self._change_ground(roughness=height / 1000.0))
        _on_user(self._friction, lambda value: self._change_ground(friction_left=value, friction_right=value))
        self._plots.window.on_update(lambda _: self._playback.seek(self._playback.time))
        self._speed.on_update(lambda _: setattr(self._playback, "speed", SPEEDS[self._speed.value]))
        self._play_button.on_click(lambda _: self._toggle())
        self._again.on_click(lambda _: self._play_choice(self._chosen))
        self._push_button.on_click(lambda _: self._push_now())
        self._no_push_button.on_click(lambda _: self._change({"push": NO_PUSH}))

    # -- actions of a user

    def _toggle(self) -> None:
        if self._playback.is_playing:
            self._playback.pause()
        else:
            self._playback.play()

    def _play_choice(self, choice: RunEpisode) -> None:
        with self._lock:
            self._chosen, self._wanted = choice, Scenario.of(choice.spec)
            self._set_sliders(self._wanted)
        self._simulate(choice.spec, self._wanted, recorded=choice.recorded)

    def _play_on(self) -> None:
        """Go on with the next window of a session, unless the user has changed this one."""
        with self._lock:
            next_name = self._chosen.next_name
            following = next((choice for choice in self._choices.values() if choice.name == next_name), None)
            if following is not None and self._wanted == Scenario.of(self._chosen.spec):
                _set(self._choice, following.label)
                self._play_choice(following)

    def _change_parameter(self, name: str, index: int, value: float) -> None:
        with self._lock:
            values = list(getattr(self._wanted, name))
            values[index] = value
            self._change({name: tuple(values)})

    def _change_push(self, **values: float) -> None:
        """Change the present push; without one, the sliders set the next push."""
        with self._lock:
            if self._wanted.push.newtons[0] > 0.0:
                self._change({"push": _with_values(self._wanted.push, values)})

    def _change_ground(self, **values: float) -> None:
        with self._lock:
            self._change({"terrain": _with_values(self._wanted.terrain, values)})

    def _push_now(self) -> None:
        begin = round(min(self._playback.time, self._wanted.config.time_limit), 2)
        values = {"newtons": self._newtons.value, "degrees": self._degrees.value, "at_seconds": begin}
        push = _with_values(Push(duration=self._wanted.config.push.duration), values)
        self._change({"push": push}, begin - SECONDS_BEFORE_PUSH)

    def _change(self, changes: Mapping[str, Any], play_from: float | None = None) -> None:
        with self._lock:
            self._wanted = replace(self._wanted, **changes)
        self._simulate(self._wanted.spec(), self._wanted, play_from)

    def _simulate(
        self,
        spec: EpisodeSpec,
        scenario: Scenario,
        play_from: float | None = None,
        recorded: Callable[[], EpisodeResult] | None = None,
    ) -> None:
        self._show_progress(0.0)
        self._simulation.request(Wish(spec, lambda result: self._take(spec, scenario, result, play_from), recorded))

    def _set_sliders(self, scenario: Scenario) -> None:
        for sliders, values in ((self._stepping, scenario.stepping), (self._balance, scenario.balance)):
            for slider, value in zip(sliders, values, strict=True):
                _set(slider, value)
        _set(self._seed, scenario.seed)
        if scenario.push.newtons[0] > 0.0:
            _set_up_to(self._newtons, scenario.push.newtons[0], LARGEST_PUSH * scenario.config.scale.mass)
            _set(self._degrees, scenario.push.degrees[0])
        conditions = conditions_of(scenario.spec().config, scenario.seed)
        _set_up_to(self._slope, scenario.terrain.slope_degrees[0], LARGEST_SLOPE)
        _set(self._uphill, scenario.terrain.direction_degrees[0] % 360.0)
        _set_up_to(self._roughness, 1000.0 * scenario.terrain.roughness[0], HIGHEST_BUMPS)
        _set_up_to(self._friction, conditions.friction_under(Side.LEFT), LARGEST_FRICTION)

    # -- the content of the page

    def _take(self, spec: EpisodeSpec, scenario: Scenario, result: EpisodeResult, play_from: float | None) -> None:
        """Play an episode that has just been simulated."""
        assert result.trace is not None
        with self._lock:
            before, self._shown = self._shown, result
            begin, end = float(result.trace.time[0]), float(result.trace.time[-1])
            self._time.min, self._time.max = 0.0, end  # in between, an older minimum would lie above a new maximum
            self._time.min = begin
            self._scene.load(result.trace, spec)
            self._plots.load(result.trace, scenario)
            self._news.content = paragraph("")
            is_changed = scenario != Scenario.of(self._chosen.spec)
            table = comparison(result, before, None if is_changed else self._chosen.score)
            self._table.content = table + paragraph(", ".join(told_settings(spec)))
        self._playback.load(begin, end, begin if play_from is None else play_from)
        if self._is_seen:
            self._playback.play()

    def _show(self, time: float) -> None:
        """Draw a frame."""
        with self._lock:
            if self._shown is None or self._shown.trace is None:
                return
            tick = self._shown.trace.tick_at(time)
            self._scene.show(tick)
            self._plots.show(time)
            self.frames += 1
            is_playing = self._playback.is_playing
            if self.frames % 3 == 0 or not is_playing:
                _set(self._time, round(time, 2))
                self._status.content = paragraph(*describe_tick(self._shown.trace, tick))
            # The label comes last, so that nothing overwrites a time that is typed in when the label is "Play".
            self._play_button.label = "Pause" if is_playing else "Play"

    def _show_progress(self, share: float) -> None:
        self._news.content = paragraph(f"simulating: {share:.0%}")

    def _show_failure(self, message: str) -> None:
        self._news.content = paragraph(f"this episode cannot be simulated: {message}")


def _with_values(settings: Any, values: Mapping[str, float]) -> Any:
    """Settings of a push or a ground, of which some ranges become single values."""
    return replace(settings, **{name: (value, value) for name, value in values.items()})


def _set(handle: Any, value: Any) -> None:
    """Change the value of an input, which viser's types declare read-only."""
    handle.value = value


def _set_up_to(slider: Any, value: float, largest: float) -> None:
    """Change the value of a slider, which reaches farther than usual where an episode does."""
    slider.max = max(largest, value, slider.value)  # in between, an older value would lie above a new maximum
    _set(slider, value)
    slider.max = max(largest, value)


def _on_user(handle: Any, do: Callable[[Any], None]) -> None:
    """Call a function with the new value when a user changes it, but not when the page does."""

    @handle.on_update
    def _(event: Any) -> None:
        if event.client is not None:
            do(handle.value)
