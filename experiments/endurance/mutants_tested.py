"""Which files have mutants, which tests have to kill them, and which mutants nothing can kill."""

from __future__ import annotations

from typing import NamedTuple


class Subject(NamedTuple):
    """A file whose mutants are tested.

    :param file: name of the file
    :param tests: arguments of pytest that select the fast tests of its package
    :param definitions: regular expression of the functions and classes that are changed; empty names are the module's
    """

    file: str
    tests: str
    definitions: str = ".*"


CONTROL = "tests/control --ignore tests/control/test_any_readings.py -k 'not episode and not papers and not short'"
EPISODE = "tests/episode/test_gait_and_reward.py"
ENDING = "tests/episode/test_ending.py -k criteria"
SENSORS = "tests/simulation/test_sensors.py -k 'not push'"
CRITIC = "tests/agents/test_naf_equations.py"
TARGETS = "tests/agents/test_naf_targets.py tests/agents/test_naf_train_eval_mode.py"
BUFFERS = "tests/agents/test_best_action.py tests/agents/test_rank_buffer.py tests/agents/test_naf_arguments.py"

SUBJECTS = (
    Subject("sarah/control/baselines.py", CONTROL),
    Subject("sarah/control/pattern_generator.py", CONTROL),
    Subject("sarah/control/hip_law.py", CONTROL),
    Subject("sarah/control/constants.py", CONTROL, "ControllerConstants"),
    Subject("sarah/control/parameters.py", CONTROL),
    Subject("sarah/episode/reward.py", EPISODE, "(?!RewardSettings).*"),
    Subject("sarah/episode/gait.py", EPISODE, "(?!GaitSettings|GaitMetrics).*"),
    Subject("sarah/episode/ending.py", ENDING, "(?!EndingSettings).*"),
    Subject("sarah/simulation/sensors.py", SENSORS),
    Subject("agents/critic.py", CRITIC),
    Subject("agents/buffers.py", BUFFERS),
    Subject("agents/naf.py", TARGETS, "train"),
)
"""All but simulations of whole episodes. Of the constants those that compute: the limits beside them catch a mistaken
unit, and are rough. Of NAF its updates, with the equations."""

EXCLUDED = (
    r"core/("
    r"RemoveDecorator"  # without @property everything fails
    r"|ReplaceBinaryOperator_BitOr_.*"  # stands in annotations only
    r"|.*_(RShift|LShift|BitOr|BitAnd|BitXor|FloorDiv|Mod|Pow)"  # mostly errors on floats
    r"|.*_(Invert|UAdd|USub_Not)|ReplaceComparisonOperator_(?!Is).*_Is(Not)?"  # errors, or the same as another
    r"|ReplaceComparisonOperator_Is(Not)?_(?!Is).*"  # the same for members of an enumeration and None
    r")"
)
"""Cosmic Ray's operators whose mutants say nothing: they would be killed by almost any test, or by none."""

AS_FLOATS = ".clip(-1, 1).astype(np.float32)"
FIRST_TICK = "the first tick ends STAND, whatever this is, and sets it"
NO_CURVATURE = "a curvature of 0 adds nothing, and none is negative"
NOT_COUNTED = "an exponential average does not ask how many it has averaged"
NO_LOAD = "a negative load is as little above a threshold as none"
NO_OUTPUT = "stable-baselines3 makes an output layer of more than 0 units only"
ROUND = "a round number, of which a few more or less say the same"
ONE_ROW = "the buffer has one row a transition, whichever environment it comes from"

EXPLAINED: dict[str, dict[str, str]] = {
    "sarah/control/pattern_generator.py": {
        "self._ticks_in_phase = 1": FIRST_TICK,
        "self._ticks_in_phase = -1": FIRST_TICK,
        "self._swing_foot_was_off = True": FIRST_TICK,
        "self._loads = {Side.LEFT: -1.0, Side.RIGHT: 0.0}": NO_LOAD,
        "self._loads = {Side.LEFT: 0.0, Side.RIGHT: -1.0}": NO_LOAD,
    },
    "sarah/episode/reward.py": {
        'if config.reward_form <= "printed":': "there are two forms, and 'symmetric' sorts behind 'printed'",
    },
    "sarah/episode/ending.py": {
        "return upright <= LEAST_UPRIGHT": "differs at 45 degrees to the last bit only",
    },
    "sarah/simulation/sensors.py": {
        "self._imu_gain = low_pass_gain(1.0 / (2.0 * math.pi * imu_bandwidth), dt) if imu_bandwidth != math.inf "
        "else 1.0": "no bandwidth is above infinity",
        "if gain >= 1.0:": "no gain is above 1",
    },
    "agents/critic.py": {
        "if self.min_curvature >= 0:": NO_CURVATURE,
        "if self.min_curvature != 0:": NO_CURVATURE,
        "if self.min_curvature > -1:": NO_CURVATURE,
        'self.shared_net = nn.Sequential(*create_mlp(features_dim, - 2, net_arch["shared"], activation_fn))': NO_OUTPUT,
        'self.shared_net = nn.Sequential(*create_mlp(features_dim, - 0, net_arch["shared"], activation_fn))': NO_OUTPUT,
        'self.register_buffer("on_diagonal", rows <= columns, persistent=False)': "a lower triangle has no entries "
        "above the diagonal",
    },
    "agents/buffers.py": {
        "n_envs: int = 2,": ONE_ROW,
        "n_envs: int = 0,": ONE_ROW,
        "weights = np.exp(self.temperature * (average_ranks(self.rewards[: self.size(), -1]) - 1))": ONE_ROW,
        "return self.actions[newest, -1], average_ranks(self.rewards[newest, 0])": ONE_ROW,
        "return self.actions[newest, 0], average_ranks(self.rewards[newest, -1])": ONE_ROW,
        "MOST_JUDGED = 10001": ROUND,
        "MOST_JUDGED = 9999": ROUND,
        "MOST_JUDGED = 11000": ROUND,
        f"drawn = np.where(np.abs(drawn) >= 1, 2 * np.sign(drawn) - drawn, drawn){AS_FLOATS}": "1 reflected is 1",
        f"drawn = np.where(np.abs(drawn) > 1, 2 / np.sign(drawn) - drawn, drawn){AS_FLOATS}": "a sign is 1 or -1",
    },
    "agents/naf.py": {
        "if self.gamma != 0:  # Otherwise what comes next does not count": "no discount is negative",
        "average_parameters(target_parameters, parameters, 2)": NOT_COUNTED,
        "average_parameters(target_parameters, parameters, 0)": NOT_COUNTED,
    },
}
"""Why some mutants survive: for each file, the changed line and the reason."""
