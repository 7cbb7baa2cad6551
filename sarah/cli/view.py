"""``sarah-view``: see the robot in the browser, and change its parameters."""

from __future__ import annotations

import contextlib
import dataclasses
import sys
import threading
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.episode_options import EpisodeOptions, parse_episode_options
from sarah.cli.former_names import with_out
from sarah.cli.next_steps import say_next, to_open
from sarah.cli.options import as_command, named_task, say_engine
from sarah.cli.subjects import check_played, episodes_of, is_shipped
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.episode.spec import EpisodeSpec
from sarah.errors import ConfigurationError
from sarah.files import check_file
from sarah.ranges import Within
from sarah.runs.config_files import changed_alike
from sarah.runs.run_episodes import RunEpisode
from sarah.simulation.engines import check_engine

COMMAND = "sarah-view"
DEFAULT_PORT = 8080
LOCAL = ("127.0.0.1", "::1", "localhost")


@dataclass(frozen=True)
class ViewOptions(EpisodeOptions):
    """Play episodes on a page in the browser, where sliders change all parameters and a button pushes the robot.

    :param subject: run folder, of a training that need not be finished; numbers separated by commas, P1 to P5 for
        stepping, or V1 to V4 for the task balance; the name of shipped parameters: ``paper``, ``stepping`` or
        ``balance``; or a log, whose motion is estimated from its sensors
    :param which: episode of a run folder: ``learned`` for the learned parameters, ``best``, or an index of its
        episodes.csv; by default ``learned``, or ``best`` if the training is not finished
    :param seed: seed of the episode, by which robot, sensors and push vary; by default the episode's own, or 0
    :param out: HTML file to write the episode to, instead of showing a page; the file needs no server
    :param robot: address at which a robot of ``sarah-robot --listen`` runs, such as tcp/127.0.0.1:7447: the page shows
        what it does now. The subject then has its dimensions
    :param authority: for TLS to that robot: certificate of the authority that has signed both certificates, a PEM file
    :param certificate: for TLS: own certificate, a PEM file
    :param key: for TLS: private key of that certificate, a PEM file
    :param host: address to serve the page at. Everyone who can reach another address than 127.0.0.1 can use the page,
        because there is no password
    :param port: port to serve the page at; the next free one if it is taken
    """

    subject: Annotated[str, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME|LOG]")] = "balance"
    which: Annotated[str | None, tyro.conf.arg(metavar="learned|best|INDEX")] = None
    seed: int | None = None
    out: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    robot: Annotated[str | None, tyro.conf.arg(metavar="ENDPOINT")] = None
    authority: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    certificate: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    key: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    host: str = "127.0.0.1"
    port: Annotated[int, Within(1, 2**16 - 1)] = DEFAULT_PORT


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    arguments = with_out(COMMAND, sys.argv[1:], {"--export": "--out"})
    options = parse_episode_options(COMMAND, arguments, ViewOptions())
    if find_spec("viser") is None:
        raise ConfigurationError("this needs the extra view: pip install '.[view]' in the clone")
    task = named_task(options.task)
    choices, chosen = episodes_of(options.subject, options.which, task)
    changed = options.applied_to(chosen.spec)
    check_played(options.subject, chosen.spec, changed if options.seed is None else None)
    if changed != chosen.spec:
        choices = [choice.of(_changed_as(choice.spec, chosen.spec, changed)) for choice in choices]
        chosen = chosen.of(changed)
    check_engine(chosen.spec.config.engine)
    if options.seed is not None:
        chosen = chosen.of(dataclasses.replace(chosen.spec, seed=options.seed))
        chosen = dataclasses.replace(chosen, label=f"{chosen.label}, with seed {options.seed}")
        choices.insert(0, chosen)
    if chosen.recorded is not None:
        chosen.recorded()  # a log that cannot be played is refused before a page opens
    if options.robot is not None:
        if options.out is not None:
            raise ConfigurationError("--robot shows a robot as it runs: leave --out out")
        _serve_live(options, options.robot, chosen.spec)
    elif options.out is not None:
        _export(options.out, chosen)
    else:
        _serve(options, choices, chosen)


def _changed_as(spec: EpisodeSpec, chosen: EpisodeSpec, changed: EpisodeSpec) -> EpisodeSpec:
    """Specification of an episode with the changes of the chosen one. The windows of a session have settings each."""
    if spec.config == chosen.config:
        return dataclasses.replace(spec, config=changed.config)
    return dataclasses.replace(spec, config=changed_alike(spec.config, chosen.config, changed.config))


def _export(path: Path, chosen: RunEpisode) -> None:
    from tqdm import tqdm

    from sarah.viewer.recording import record
    from sarah.viewer.server import serving

    check_file(path)
    if path.suffix.lower() not in (".html", ".htm"):
        raise ConfigurationError(f"an exported page must end in .html, not {path.name!r}; sarah-video makes videos")
    bar = tqdm(total=1.0, desc=chosen.label, bar_format="{desc}: {percentage:3.0f}% {bar}", disable=None)
    with bar, serving("127.0.0.1", DEFAULT_PORT) as server:
        record(server, chosen.spec, path, lambda share: bar.update(share - bar.n), chosen.recorded)
    print(path)
    say_next(to_open(path))


def _serve_live(options: ViewOptions, robot: str, spec: EpisodeSpec) -> None:
    from sarah.cli.endpoints import endpoint_of
    from sarah.remote.client import Client
    from sarah.viewer.live import LiveRobot
    from sarah.viewer.server import serving

    endpoint = endpoint_of(robot, options.authority, options.certificate, options.key)
    with Client(endpoint) as client, serving(options.host, options.port) as server:
        live = LiveRobot(server, spec)
        _say_address(options, server.get_port())
        with contextlib.suppress(KeyboardInterrupt):
            for telemetry in client.telemetry():
                live.show(telemetry)


def _say_address(options: ViewOptions, port: int) -> None:
    if options.host not in LOCAL:
        print(f"warning: everyone who can reach {options.host} can use this page, because there is no password")
    print(f"SARAH is at http://{options.host}:{port} (Ctrl-C ends)", flush=True)


def _serve(options: ViewOptions, choices: list[RunEpisode], chosen: RunEpisode) -> None:
    from sarah.viewer.page import Page
    from sarah.viewer.server import serving

    with serving(options.host, options.port) as server:
        page = Page(server, choices, chosen)
        say_engine(chosen.spec.config)
        if is_shipped(options.subject):
            print(f"{options.subject}: {PARAMETER_SETS[options.subject].origin}")
        _say_address(options, server.get_port())
        with contextlib.suppress(KeyboardInterrupt):
            threading.Event().wait()
        page.close()
