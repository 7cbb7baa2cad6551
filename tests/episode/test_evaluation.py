"""What many episodes have in common."""

from collections.abc import Callable

import pytest
from laboratory import CONTROL_DT, RESULT

from sarah.control.parameters import PAPER_STEPPING
from sarah.episode.episode import Episode
from sarah.episode.evaluation import Evaluation, evaluate
from sarah.episode.settings import EpisodeConfig
from sarah.errors import ConfigurationError

SHORT = EpisodeConfig(time_limit=4.0)


def shaken_by(amplitude: float) -> Evaluation:
    """The same episode, with flexions that a controller shakes at half the control rate."""
    with Episode(SHORT, 0) as episode:
        episode.stand()
        simulation = episode.robot.simulation
        send = simulation.set_targets

        def shaken(targets: tuple[float, ...]) -> None:
            flexion = amplitude if round(simulation.time / CONTROL_DT) % 2 else -amplitude
            send((*targets[:2], flexion, flexion, *targets[4:]))

        simulation.set_targets = shaken  # type: ignore[method-assign]
        return Evaluation((episode.run(PAPER_STEPPING),))


def test_chattering_hips_show_as_vibration() -> None:
    calm, chattering = shaken_by(0.0), shaken_by(0.02)
    assert chattering.chatters(calm) and not calm.chatters(calm)
    assert chattering.mean("actuator_power") > calm.mean("actuator_power")
    assert chattering.statistic("peak_hip_rate", "max") > 10 * calm.statistic("peak_hip_rate", "max")


def test_arguments_of_another_kind_are_named() -> None:
    one = Evaluation((RESULT,))
    calls: dict[str, Callable[[], object]] = {
        "seeds must not be empty: an evaluation needs an episode": lambda: evaluate(
            "stepping", PAPER_STEPPING, SHORT, []
        ),
        r"unknown metric 'scor', did you mean 'score'\? .*": lambda: one.mean("scor"),
        r"seeds must be several whole numbers, such as range\(10\), not 3": lambda: evaluate(
            "stepping",
            PAPER_STEPPING,
            SHORT,
            3,  # type: ignore[arg-type]
        ),
        r"workers must be an executor, as in .*, not 4": lambda: evaluate(
            "stepping",
            PAPER_STEPPING,
            SHORT,
            [1],
            4,  # type: ignore[arg-type]
        ),
        r"unknown statistic 'medain', did you mean 'median'\? .*": lambda: one.statistic("score", "medain"),
    }
    for words, call in calls.items():
        with pytest.raises(ConfigurationError, match=f"^{words}$"):
            call()
