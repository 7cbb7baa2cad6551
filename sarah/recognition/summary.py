"""What a recognised robot's session came to, in words: what the robot was like, and which known set it ran."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sarah.control.parameters import Parameters
from sarah.operation.window import Window
from sarah.recognition.belief import distances, is_known, place_of
from sarah.recognition.felt import features_of
from sarah.recognition.recognition import Recognition
from sarah.robot.scale import Scale


def likeness(recognition: Recognition, windows: Sequence[Window], scale: Scale) -> str:
    """Which known kinds the robot was like at first, in words.

    :param recognition: what logs teach
    :param windows: windows of the session; the second one counts if the robot fell in the first
    :param scale: size of the robot
    """
    felt = windows[1 if windows[0].fell and len(windows) > 1 else 0].felt
    place = place_of(recognition, features_of(felt, scale))
    if not is_known(recognition, place):
        return f"unlike all {len(recognition.kinds)} known kinds"
    nearest = [recognition.kinds[index] for index in np.argsort(distances(recognition, place), kind="stable")[:2]]
    return "most like " + ", and then ".join(f'"{kind}"' for kind in nearest)


def known_set_run(recognition: Recognition, windows: Sequence[Window], left: Parameters) -> str:
    """When a known set first ran, and whether the robot is left with it, in words.

    :param recognition: what logs teach
    :param windows: windows of the session
    :param left: parameters that the robot is left with
    """
    known = set(recognition.sets) - {recognition.reference}
    first = next((window for window in windows if window.parameters in known), None)
    if first is None:
        return "none ran, as none was believed to be better"
    end = "with it" if left == first.parameters else "with another known one" if left in known else "with others"
    return f"first in window {first.index}, and the robot is left {end}"
