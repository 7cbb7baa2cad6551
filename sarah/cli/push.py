"""``sarah-push``: give new parameters to a robot that runs, or let it stand, step or say what it does."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from sarah.cli.endpoints import endpoint_of
from sarah.cli.options import as_command, named_task, parse_options
from sarah.cli.subjects import learned_of, numbers
from sarah.control.parameters import BALANCE_PARAMETERS, STEPPING_PARAMETERS
from sarah.episode.task_answers import controller_of
from sarah.errors import ConfigurationError
from sarah.operation.settings import BOX
from sarah.ranges import Within, check_ranges
from sarah.remote.answers import Answer, Outcome, Telemetry, to_json
from sarah.remote.client import WAIT_SECONDS, Client
from sarah.remote.endpoints import DEFAULT_ENDPOINT, Endpoint
from sarah.remote.requests import LearnedWith, Request

COMMAND = "sarah-push"
NUMBERS = {
    len(group): [one.name for one in group] for group in (STEPPING_PARAMETERS, BALANCE_PARAMETERS, BOX.parameters)
}
"""Names of parameters that are given as numbers, by how many there are."""


@dataclass(frozen=True)
class PushOptions:
    """Push new parameters to a robot that runs with ``sarah-robot --listen``.

    They are applied when its legs swap, or at once while it stands. The command waits until the robot has stepped with
    them for five seconds, or until the supervisor has put back the old ones.

    :param subject: run folder; numbers separated by commas, P1 to P5, V1 to V4 or all nine; or the name of shipped
        parameters: ``paper``, ``stepping`` or ``balance``. Parameters that it does not have stay
    :param task: task of a run folder whose task is that of a file, such as my_task.py:JUMP
    :param to: address at which the robot listens
    :param stand: whether the robot is to stop and stand
    :param step: whether the robot is to step again
    :param state: whether the robot is to say what it does
    :param json: whether to print what the robot answers as JSON, one answer a line
    :param wait: whether to wait until the new parameters are proven
    :param seconds: time to wait for the robot's answers, in s
    :param authority: for TLS: certificate of the authority that has signed those of robot and pusher, a PEM file
    :param certificate: for TLS: own certificate, a PEM file
    :param key: for TLS: private key of that certificate, a PEM file
    """

    subject: Annotated[str | None, tyro.conf.Positional, tyro.conf.arg(metavar="[RUN|NUMBERS|NAME]")] = None
    task: Annotated[str | None, tyro.conf.arg(metavar="TASK")] = None
    to: Annotated[str, tyro.conf.arg(metavar="ENDPOINT")] = DEFAULT_ENDPOINT
    stand: bool = False
    step: bool = False
    state: bool = False
    json: bool = False
    wait: bool = True
    seconds: Annotated[float, Within(0.1, 3600.0, "s")] = WAIT_SECONDS
    authority: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    certificate: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None
    key: Annotated[Path | None, tyro.conf.arg(metavar="FILE")] = None

    def __post_init__(self) -> None:
        """Refuse numbers outside their ranges."""
        check_ranges("", self)

    def check_one(self) -> None:
        """Refuse to ask for nothing, or for two things at once."""
        if (self.subject is not None) + self.stand + self.step + self.state != 1:
            raise ConfigurationError("give one of parameters, --stand, --step and --state")

    @property
    def endpoint(self) -> Endpoint:
        """Where the robot listens."""
        return endpoint_of(self.to, self.authority, self.certificate, self.key)


@as_command(COMMAND)
def main() -> None:
    """Run the command with the arguments of the process."""
    options = parse_options(PushOptions, COMMAND, sys.argv[1:], PushOptions())
    options.check_one()
    request = request_of(options)
    with Client(options.endpoint) as client:
        if options.state:
            _say_state(client.state(options.seconds), options.json)
            return
        for answer in client.ask(request, options.seconds):
            _say(answer, options.json)
            if answer.outcome is Outcome.APPLIED and not options.wait:
                break
    if answer.outcome not in (Outcome.APPLIED, Outcome.KEPT):
        raise SystemExit(1)


def request_of(options: PushOptions) -> Request:
    """What the options ask for.

    :param options: options of the command
    :raises ConfigurationError: if there is no such subject
    """
    if options.subject is None:
        return Request("stand" if options.stand else "step" if options.step else "state")
    if options.subject.strip(" +-.")[:1].isdigit() and not Path(options.subject).is_dir():
        values = numbers(options.subject)
        if len(values) not in NUMBERS:
            raise ConfigurationError(f"parameters must be 5 numbers (P1 to P5), 4 (V1 to V4) or 9, not {len(values)}")
        return Request("push", dict(zip(NUMBERS[len(values)], values, strict=True)))
    spec, _ = learned_of(options.subject, named_task(options.task))
    stepping, balance = controller_of(spec.task, spec.parameters, spec.config)
    given = {**vars(stepping), **({} if balance is None else vars(balance))}
    return Request("push", given, LearnedWith.of(spec.config))


def _say(answer: Answer, as_json: bool) -> None:
    """Print an answer."""
    if as_json:
        print(to_json(answer).decode(), flush=True)
        return
    where = "" if answer.tick is None else f" at tick {answer.tick} ({answer.seconds:.2f} s, {answer.state}"
    phase = f", {answer.phase})" if answer.state == "stepping" else ")"
    reason = f": {answer.reason}" if answer.reason else ""
    print(f"{answer.outcome.value}{where and where + phase}{reason}", flush=True)


def _say_state(telemetry: Telemetry, as_json: bool) -> None:
    """Print what the robot does."""
    if as_json:
        print(to_json(telemetry).decode())
        return
    print(f"state: {telemetry.state}" + (f" ({telemetry.reason})" if telemetry.reason else ""))
    print(f"time: {telemetry.seconds:.2f} s, tick {telemetry.tick}, {telemetry.late_ticks} late ticks")
    print(f"steps: {telemetry.steps_per_second:g} per second, phase {telemetry.phase}")
    print("parameters: " + ", ".join(f"{name} {value:g}" for name, value in telemetry.parameters.items()))
