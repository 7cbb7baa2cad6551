"""The drawing of the robot with its dimensions."""

from itertools import combinations
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.transforms import Bbox, BboxBase

from sarah.pictures.dimension_figure import draw_dimensions
from sarah.pictures.dimension_marks import CENTRE_OF_MASS, marks
from sarah.robot.description import describe_robot
from sarah.robot.dimensions import all_dimensions, default_dimensions

SMALL = {name: 0.12345 * value for name, value in default_dimensions().items()}
STILTS = {"thigh_length": 1.5, "shank_length": 2.5, "sole_half_width": 0.02}
DWARF = {"thigh_length": 0.05, "shank_length": 0.05, "torso_height": 0.9, "hip_drop": 0.45, "flexion_limit": 2.5}
FEET = {"forefoot_contact": 0.6, "hindfoot_contact": 0.03, "ankle_up_limit": 1.4, "hinge_height": 0.05}
ROBOTS: list[dict[str, float]] = [{}, SMALL, STILTS, DWARF, FEET]


@pytest.mark.parametrize("changed", ROBOTS)
def test_every_dimension_is_marked_and_each_arrow_is_as_long_as_it_says(changed: dict[str, float]) -> None:
    dimensions = all_dimensions(changed)
    shown = [mark for panel in marks(dimensions, np.zeros(3)).values() for mark in panel]
    assert sorted(mark.name for mark in shown) == sorted([*dimensions, CENTRE_OF_MASS])
    for mark in shown:
        if len(mark.points) == 2:
            along = 2 if mark.beside in ("left", "right") else slice(None, 2)
            length = np.linalg.norm(np.diff(mark.points, axis=0)[0, along])
            assert length == pytest.approx(dimensions[mark.name]), mark.name


@pytest.mark.parametrize("changed", ROBOTS)
def test_names_are_readable_whatever_the_proportions(
    changed: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[tuple[str, str, Bbox]] = []
    edges: list[BboxBase] = []

    def look(figure: Figure, *_: object, **__: object) -> None:
        texts = [text for axis in figure.axes for text in axis.texts if text.get_text()]
        seen.extend((text.get_text(), str(text.get_fontweight()), text.get_window_extent()) for text in texts)
        edges.append(figure.bbox)

    monkeypatch.setattr(Figure, "savefig", look)
    dimensions = all_dimensions(changed)
    draw_dimensions(describe_robot(changed), dimensions, Path("robot.png"))
    overlapping = [
        (one, other)
        for (one, _, a), (other, _, b) in combinations(seen, 2)
        if a.shrunk(0.98, 0.9).overlaps(b.shrunk(0.98, 0.9))
    ]
    assert overlapping == []
    assert [text for text, _, box in seen if (Bbox.union([box, *edges]).bounds != edges[0].bounds)] == []
    assert {text.splitlines()[0] for text, weight, _ in seen if weight == "bold"} == dict(
        dimensions.items() - default_dimensions().items()
    ).keys()


def test_it_is_a_picture(tmp_path: Path) -> None:
    draw_dimensions(describe_robot(), default_dimensions(), tmp_path / "robot.png")
    picture = plt.imread(tmp_path / "robot.png")
    assert picture.shape[1] == 1520 and picture[..., :3].std() > 0.05
