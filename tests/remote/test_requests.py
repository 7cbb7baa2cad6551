"""Requests as JSON: what is refused, and that the document for other programs says the same."""

import contextlib
import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given
from hypothesis import strategies as st

import sarah.remote
from sarah.control.constants import ControllerConstants
from sarah.errors import RobotError, SarahError
from sarah.operation.settings import PARAMETERS
from sarah.remote.answers import Answer, Outcome, from_json, to_json
from sarah.remote.requests import LARGEST_BYTES, LearnedWith, Request, WindowTimes, read_request
from sarah.robot.dimensions import all_dimensions

SCHEMA = json.loads(Path(sarah.remote.__file__).with_name("request.schema.json").read_text())
VALID: dict[str, Any] = {
    "schema": 1,
    "kind": "push",
    "values": {"P1": 0.4, "V4": -2},
    "learned_with": {"controller": {"pad_threshold": 20.0}, "control_rate": 100, "dimensions": {"torso_mass": 12.0}},
}
WINDOW: dict[str, Any] = {
    "schema": 1,
    "kind": "window",
    "values": {"P1": 0.4},
    "window": {"settle_seconds": 2.0, "measure_seconds": 4},
    "learner": "mine",
}


def test_a_request_comes_back_from_json() -> None:
    every = {parameter.name: parameter.high for parameter in PARAMETERS}
    window = Request("window", every, window=WindowTimes(0.0, 0.5), learner="mine")
    for request in (Request("state"), window, Request("push", every, LearnedWith(dimensions={"torso_mass": 12.0}))):
        assert read_request(request.to_json()) == request and len(request.to_json()) < LARGEST_BYTES
        jsonschema.validate(json.loads(request.to_json()), SCHEMA)


def changed(change: Callable[[dict[str, Any]], Any], valid: dict[str, Any] = VALID) -> bytes:
    content = json.loads(json.dumps(valid))
    change(content)
    return json.dumps(content).encode()


@pytest.mark.parametrize(
    ("message", "reason"),
    [
        (b"", "not JSON"),
        (b"\xff", "not JSON"),
        (b"[" * 5000, "not JSON"),
        (b"[]", "a request must be a JSON object, not []"),
        (b'{"schema": 1, "kind": "stand", "kind": "step"}', "not JSON: a name comes twice"),
        (b" " * (LARGEST_BYTES + 1), "a message has at most 8192 bytes, not 8193"),
        (changed(lambda it: it.update(schema=2)), "schema must be 1, not 2"),
        (changed(lambda it: it.update(schema=True)), "schema must be 1, not True"),
        (changed(lambda it: it.update(kind="pusch")), "unknown kind of request 'pusch', did you mean 'push'?"),
        (
            changed(lambda it: it.update(kind=["push"])),
            "kind must be one of push, stand, step, state, window, identity, not ['push']",
        ),
        (changed(lambda it: it.update(kind="stand")), "a request to stand has no values"),
        (changed(lambda it: it.update(values={})), "a request to push has to have values"),
        (changed(lambda it: it.update(values=[0.4])), "values must hold names and numbers, not [0.4]"),
        (changed(lambda it: it.update(value={})), "unknown key 'value', did you mean 'values'?"),
        (changed(lambda it: it["values"].update(P6=1.0)), "unknown parameter 'P6'"),
        (changed(lambda it: it["values"].update(P1=2.1)), "parameter P1 must be between 0 and 2, not 2.1"),
        (changed(lambda it: it["values"].update(P1=float("nan"))), "not JSON: NaN is no number"),
        (changed(lambda it: it["values"].update(P1=10**400)), "parameter P1 must be between 0 and 2, not 1000"),
        (changed(lambda it: it["values"].update(P1="0.4")), "parameter P1 must be between 0 and 2, not '0.4'"),
        (changed(lambda it: it["values"].update(P1=True)), "parameter P1 must be between 0 and 2, not True"),
        (changed(lambda it: it.update(learned_with=None)), "learned_with must hold controller, control_rate"),
        (changed(lambda it: it["learned_with"].update(seed=1)), "unknown key 'seed'"),
        (changed(lambda it: it["learned_with"].update(control_rate=0)), "control_rate must be between 1 and 10000"),
        (changed(lambda it: it["learned_with"].update(dimensions=[])), "dimensions must hold names and numbers"),
        (changed(lambda it: it["learned_with"]["dimensions"].update(torso=1.0)), "unknown robot dimension 'torso'"),
        (changed(lambda it: it["learned_with"]["controller"].update(pads=1)), "unknown key 'controller.pads'"),
        (changed(lambda it: it["window"].update(settle_seconds=61), WINDOW), "window.settle_seconds must be between"),
        (
            changed(lambda it: it["window"].update(measure_seconds="4"), WINDOW),
            "window.measure_seconds must be a number",
        ),
        (changed(lambda it: it["window"].update(measure=4), WINDOW), "unknown key 'window.measure', did you mean"),
        (changed(lambda it: it.update(window=None), WINDOW), "window must hold keys and values, not None"),
        (changed(lambda it: it.update(kind="push"), WINDOW), "a request to push has no window"),
        (changed(lambda it: it.pop("window"), WINDOW), "a request to window has to have a window"),
        (changed(lambda it: it.pop("values"), WINDOW), "a request to window has to have values"),
        (changed(lambda it: it.pop("learner"), WINDOW), "learner must be a name of 1 to 64 characters"),
        (changed(lambda it: it.update(learner="x" * 65), WINDOW), "learner must be a name of 1 to 64 characters"),
        (changed(lambda it: it.update(learner=7), WINDOW), "learner must be a name of 1 to 64 characters, not 7"),
    ],
)
def test_a_wrong_request_is_refused_with_one_line(message: bytes, reason: str) -> None:
    with pytest.raises(SarahError) as error:
        read_request(message)
    assert str(error.value).startswith(reason) and "\n" not in str(error.value)


PIECES = st.recursive(
    st.none()
    | st.booleans()
    | st.integers(-3, 200)
    | st.floats(-3.0, 3.0)
    | st.sampled_from(["push", "stand", "", "P1"]),
    lambda inner: (
        st.lists(inner, max_size=2)
        | st.dictionaries(st.sampled_from(["schema", "kind", "values", "P1", "V4", "controller"]), inner, max_size=3)
    ),
    max_leaves=5,
)
SHARED = (("schema",), ("kind",), ("values",), ("values", "P1"))
PATHS = [(VALID, path) for path in (*SHARED, ("learned_with",), ("learned_with", "control_rate"))]
PATHS += [(WINDOW, path) for path in (*SHARED, ("window",), ("window", "settle_seconds"), ("learner",))]


@given(st.sampled_from(PATHS), PIECES, st.booleans())
def test_the_document_and_the_robot_accept_the_same(
    place: tuple[dict[str, Any], tuple[str, ...]], piece: Any, is_gone: bool
) -> None:
    whole, path = place
    content = json.loads(json.dumps(whole))
    inner = content
    for name in path[:-1]:
        inner = inner[name]
    if is_gone:
        del inner[path[-1]]
    else:
        inner[path[-1]] = piece
    valid = jsonschema.Draft202012Validator(SCHEMA).is_valid(content)
    try:
        read_request(json.dumps(content).encode())
    except SarahError:
        assert not valid or path == ("learned_with",)  # the robot also knows the names of constants
    else:
        assert valid


@given(st.integers(0, 300), st.binary(max_size=3))
def test_what_is_cut_or_overwritten_raises_nothing_else(place: int, bytes_: bytes) -> None:
    whole = json.dumps(VALID).encode()
    for message in (whole[:place], whole[:place] + bytes_ + whole[place + len(bytes_) :]):
        with contextlib.suppress(SarahError):
            read_request(message)


def test_the_document_has_the_ranges_of_the_parameters() -> None:
    found = {
        name: (one["minimum"], one["maximum"]) for name, one in SCHEMA["properties"]["values"]["properties"].items()
    }
    assert found == {parameter.name: (parameter.low, parameter.high) for parameter in PARAMETERS}


def test_another_controller_or_robot_is_told_apart() -> None:
    own = LearnedWith()
    assert own.difference(LearnedWith(dimensions={"torso_mass": all_dimensions({})["torso_mass"]})) == ""
    assert LearnedWith(control_rate=50).difference(own) == "control_rate is 50 and not 100"
    assert LearnedWith(ControllerConstants(pad_threshold=20.0)).difference(own) == "pad_threshold is 20 and not 30"
    assert "dimension torso_mass is 12 and not" in LearnedWith(dimensions={"torso_mass": 12.0}).difference(own)


def test_an_answer_comes_back_from_json_others_are_refused() -> None:
    answer = Answer(Outcome.KEPT, "", True, 3, 0.03, "stepping", "lift")
    assert from_json(Answer, to_json(answer)) == answer
    for text in (
        b"{}",
        b"[]",
        b"x",
        to_json(answer).replace(b"kept", b"kept?"),
        to_json(answer).replace(b": 1,", b": 2,"),
    ):
        with pytest.raises(RobotError, match="not one of schema 1"):
            from_json(Answer, text)
