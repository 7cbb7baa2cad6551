"""A learner and the control loop of a robot in one program, without a connection between them.

One sees what each window was worth by the robot's own sensors. Give the loop a driver of your own, and ``RealTime`` as
its pacing, and the robot is yours.
"""

from dataclasses import replace

from sarah.control.parameters import Parameters
from sarah.drivers.simulated_robot import simulated_loop
from sarah.episode.parameter_sets import PARAMETER_SETS
from sarah.operation.settings import SHIPPED, OperationConfig
from sarah.operation.window import Window
from sarah.remote.driven_robot import DrivenRobot
from sarah.remote.measurement import Meter
from sarah.remote.remote_robot import RemoteRobot
from sarah.remote.slot import Slot
from sarah.training.session_learners import LEARNERS


def show(window: Window) -> None:
    """Print what a window was worth."""
    print(f"window {window.index}: {window.observed_reward:.3f}{', fell' * window.fell}")


spec = PARAMETER_SETS["balance"].spec
config = replace(
    spec.config,
    supervisor=replace(spec.config.supervisor, enabled=True),
    randomisation=replace(spec.config.randomisation, actuator_bandwidth=(12.0, 12.0)),  # weak servos
)
_, loop = simulated_loop(replace(spec, config=config), goes_on=True)
driven = DrivenRobot(loop, Slot(loop.dt, meter=Meter(config)))
robot = RemoteRobot(OperationConfig(minutes=0.7), lambda: driven, "this program", show)
left: Parameters = LEARNERS["careful"](robot, SHIPPED, 0)
robot.leave(left)
print("left with", ", ".join(f"{value:.2f}" for value in left))
