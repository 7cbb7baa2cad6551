"""Robots that the controller runs on: the protocol of a driver, the simulated robot, and the control loop."""
