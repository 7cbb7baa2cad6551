"""What a user can get wrong with ``sarah-train`` is answered in one line that names it, and nothing is written."""

from collections.abc import Callable
from pathlib import Path

import pytest

PUSHED = "--task balance --episode"
MISTAKES = {
    "unknown names": [
        ("--task steping", "unknown task 'steping', did you mean 'stepping'?"),
        ("--task balence", "unknown task 'balence', did you mean 'balance'?"),
        ("--algo naff", "unknown algo 'naff', did you mean 'naf'?"),
        ("--algo NAF", "unknown algo 'NAF', did you mean 'naf'?"),
        ("--algo cmaes", "unknown algo 'cmaes', did you mean 'cma-es'?"),
        ("--engine mujco", "unknown --engine/--episode.engine 'mujco', did you mean 'mujoco'?"),
        ("--episods 5", "did you mean --episodes?"),
        ("--episode 5", "did you mean --episodes?"),
        ("--fron run", "did you mean --from?"),
        ("--episode.phisics.rate 300", "did you mean --episode.physics.rate?"),
        ("--episode.controller.time-out 1", "did you mean --episode.controller.time-out-seconds?"),
        ("--episode.reward-form print", "--episode.reward-form"),
        ("--episode.dimensions tigh_length 0.3", "did you mean 'thigh_length'?"),
        ("--episode.dimensions foot_length 0.2", "unknown robot dimension 'foot_length'"),
        ("balance", "'balance' is no option: a task is given as --task balance"),
    ],
    "wrong types": [
        ("--task", "--task"),
        ("--episodes many", "--episodes must be a whole number, not 'many'"),
        ("--episodes 1e3", "--episodes must be a whole number, not '1e3'"),
        ("--episodes 10.5", "--episodes must be a whole number, not '10.5'"),
        ("--simulations 10.5", "--episodes must be a whole number, not '10.5'"),
        ("--seed x", "--seed must be a whole number, not 'x'"),
        ("--slots", "--slots"),
        ("--config", "--config"),
        ("--resume", "--resume"),
        ("--workers two", "--workers must be a whole number, not 'two'"),
        ("--episode.time-limit 30s", "--episode.time-limit must be a number, not '30s'"),
        ("--episode.controller.leg-speed fast", "--episode.controller.leg-speed must be a number, not 'fast'"),
        (f"{PUSHED}.stepping 1 1 1", "--episode.stepping"),
        (f"{PUSHED}.push.newtons", "--episode.push.newtons"),
        (f"{PUSHED}.push.newtons=20000", "push.newtons must be between 0 and 10000 N"),
    ],
    "out of any plausible range": [
        ("--episodes -5", "episodes must be between 1 and 1000000, not -5"),
        ("--episodes 100000000", "episodes must be between 1 and 1000000, not 100000000"),
        ("--simulations 0", "episodes must be between 1 and 1000000, not 0"),
        ("--slots 0", "slots must be between 1 and 10000, not 0"),
        ("--slots 100000", "slots must be between 1 and 10000, not 100000"),
        ("--seed -1", "seed must be between 0 and 2147483647, not -1"),
        ("--seed 2147483648", "seed must be between 0 and 2147483647, not 2147483648"),
        ("--workers -1", "workers must be between 0 and 256, not -1"),
        ("--workers 100000", "workers must be between 0 and 256, not 100000"),
        ("--episode.time-limit 30000", "time_limit must be between 1 and 3600 s, not 30000.0"),
        ("--episode.time-limit nan", "--episode.time-limit must be a number, not 'nan'"),
        ("--episode.time-limit -5", "time_limit must be between 1 and 3600 s, not -5.0"),
        ("--episode.time-limit 1.001", "time_limit must be above the 1 s of standing, not 1.001"),
        ("--episode.physics.rate 1000000", "physics.rate must be between 50 and 20000 Hz, not 1000000"),
        ("--episode.physics.rate 50", "physics.rate must be a multiple of the control rate, 100 Hz"),
        ("--episode.physics.rate 250", "physics.rate must be a multiple of the control rate, 100 Hz"),
        ("--episode.physics.control-rate 0", "physics.control_rate must be between 50 and 1000 Hz, not 0"),
        ("--episode.physics.control-rate 5", "physics.control_rate must be between 50 and 1000 Hz, not 5"),
        ("--episode.physics.solver-iterations 1000000", "physics.solver_iterations must be between 1 and 10000"),
        ("--episode.controller.time-out-seconds 0", "controller.time_out_seconds must be between 0.01 and 100 s"),
        ("--episode.controller.leg-speed nan", "--episode.controller.leg-speed must be a number, not 'nan'"),
        ("--episode.dimensions thigh_length 330", "must be a number between 0.033 and 3.3 m, not 330.0"),
        ("--episode.dimensions thigh_length nan", "--episode.dimensions must be a number, not 'nan'"),
        ("--episode.dimensions torso_mass 8000", "'torso_mass' must be a number between 0.08 and 800"),
        ("--episode.randomisation.friction 0.7 70", "randomisation.friction must be between 0 and 5"),
        ("--episode.randomisation.friction 1 0.5", "in rising order, not (1.0, 0.5)"),
        ("--episode.randomisation.mass-deviation 5", "randomisation.mass_deviation must be between 0 and 0.9"),
        ("--episode.randomisation.imu-bandwidth 0", "imu_bandwidth must be between 0.1 and 100000"),
        ("--episode.randomisation.delay-seconds 10", "delay_seconds must be between 0 and 1 s, not 10.0"),
        ("--episode.randomisation.acceleration-bias inf", "acceleration-bias must be a number, not 'inf'"),
        ("--episode.randomisation.imu-tilt-degrees 90", "imu_tilt_degrees must be between 0 and 45 degrees, not 90.0"),
        ("--episode.randomisation.mass-offset 10", "randomisation.mass_offset must be between 0 and 0.1 m, not 10.0"),
        ("--episode.randomisation.pad-gain 20", "randomisation.pad_gain must be between 0 and 0.9, not 20.0"),
        ("--episode.randomisation.pad-noise-density -1", "pad_noise_density must be between 0 and 100 N per root Hz"),
        (f"{PUSHED}.push.newtons 0 100000", "push.newtons must be between 0 and 10000 N"),
        (f"{PUSHED}.push.newtons 50 20", "push.newtons must be between 0 and 10000 N and in rising order"),
        (f"{PUSHED}.push.degrees -90 90", "push.degrees must be between 0 and 720 degrees"),
        (f"{PUSHED}.push.at-seconds 0.5 2", "push.at_seconds must be between 1 and 3600 s"),
        (f"{PUSHED}.push.duration 150", "push.duration must be between 0 and 10 s, not 150.0"),
        (f"{PUSHED}.push.duration 0.004", "push.duration must be at least a control tick, 0.01 s, not 0.004"),
        (f"{PUSHED}.stepping 1 1 1 1 3", "parameter P5 must be between 0 and 2, not 3.0"),
        (f"{PUSHED}.stepping 1 1 1 1 nan", "--episode.stepping"),
    ],
    "contradictions": [
        ("--task stepping --episode.push.newtons 50 60", "--episode.push.newtons is for --task balance"),
        ("--episode.push.degrees 0 90", "--episode.push.degrees is for --task balance"),
        ("--episode.stepping 1 1 1 1 1", "--episode.stepping is for --task balance"),
        ("--engine mujoco --episode.physics.added-plate-inertia 0.01", "--episode.physics.added-plate-inertia"),
        ("--from full", "--from is for --task balance, not 'stepping'"),
        ("--workers 2 --scheduler tcp://127.0.0.1:9", "give one of the two"),
        ("--scheduler nonsense", "no Dask scheduler answers at 'nonsense'"),
        (f"{PUSHED}.time-limit 1.5 --episode.push.at-seconds 2 3", "before the time_limit of 1.5 s"),
    ],
    "files and folders": [
        ("--config full", "cannot read full: it is not a regular file"),
        ("--config nothing.yaml", "cannot read nothing.yaml"),
        ("--out full", "run folder full is not empty: name another with --out"),
        ("--out full/precious.txt", "cannot write run folder"),
        ("--out x --simulations=0", "episodes must be between 1"),
        ("--resume full", "full is not the folder of a training: it has no config.yaml"),
        ("--resume nowhere", "run folder nowhere does not exist"),
        ("--task balance --from nowhere", "run folder nowhere does not exist"),
        ("--task balance --from full", "not the folder of a finished training"),
    ],
}


@pytest.mark.parametrize(("arguments", "message"), [mistake for mistakes in MISTAKES.values() for mistake in mistakes])
def test_mistakes_get_one_line_and_leave_everything_alone(
    arguments: str, message: str, answer: Callable[[str], str], tmp_path: Path
) -> None:
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "precious.txt").write_text("data")
    assert message in answer(f"sarah-train {arguments}")
