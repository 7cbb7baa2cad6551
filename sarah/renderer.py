"""Pictures of the robot, in a world of their own: the one that is simulated holds nothing that can be seen."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from sarah.bullet import give_back_client, load_robot, pybullet, take_client
from sarah.description import RobotDescription
from sarah.sensors import Vector
from sarah.simulator import STANDARD_CAMERA, Camera


class Renderer:
    """Draws a robot in any pose, by PyBullet's software renderer.

    :param robot: the checked robot
    """

    def __init__(self, robot: RobotDescription) -> None:
        self._client = take_client()
        try:
            shape = pybullet.createCollisionShape(pybullet.GEOM_PLANE, physicsClientId=self._client)
            pybullet.createMultiBody(0.0, shape, physicsClientId=self._client)
            self._body, self._indices = load_robot(self._client, robot.urdf, robot.standing_height, flags=0)
        except BaseException:
            self.close()
            raise

    def draw(
        self,
        position: Vector,
        orientation: tuple[float, float, float, float],
        joints: Mapping[str, float],
        width: int = 640,
        height: int = 480,
        camera: Camera = STANDARD_CAMERA,
    ) -> np.ndarray:
        """Draw one pose.

        :param position: of the torso's centre, in m
        :param orientation: of the torso: unit quaternion (x, y, z, w)
        :param joints: positions in rad and m by name; joints that are not named stay where they were, at first at zero
        :param width: of the picture, in pixels
        :param height: of the picture, in pixels
        :param camera: where to look from
        :return: uint8 array of shape (height, width, 3)
        """
        client = self._client
        pybullet.resetBasePositionAndOrientation(self._body, position, orientation, physicsClientId=client)
        for name, value in joints.items():
            pybullet.resetJointState(self._body, self._indices[name], value, physicsClientId=client)
        x, y, _ = position
        view = pybullet.computeViewMatrixFromYawPitchRoll(
            (x, y, camera.height), camera.distance, camera.yaw, camera.pitch, roll=0.0, upAxisIndex=2
        )
        projection = pybullet.computeProjectionMatrixFOV(fov=45.0, aspect=width / height, nearVal=0.05, farVal=10.0)
        image = pybullet.getCameraImage(
            width, height, view, projection, renderer=pybullet.ER_TINY_RENDERER, physicsClientId=client
        )
        return np.reshape(np.asarray(image[2], dtype=np.uint8), (height, width, 4))[:, :, :3]

    def close(self) -> None:
        """Give PyBullet's client back; nothing can be drawn any more."""
        if self._client >= 0:
            give_back_client(self._client)
            self._client = -1
