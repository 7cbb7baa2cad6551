"""The robot as a xacro; see :mod:`sarah.robot.description`."""
