"""Pictures of the robot, drawn in a world of their own: the simulated world contains nothing visible."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

import numpy as np
from PIL import Image

from sarah.errors import ConfigurationError
from sarah.robot.description import ACTUATED_JOINTS, ANKLE_JOINTS, PLATES, RobotDescription
from sarah.robot.reading import Side, Vector
from sarah.simulation.engines import INSTALLATION, is_installed
from sarah.simulation.pybullet_client import give_back_client, load_robot, pybullet, take_client
from sarah.simulation.scenery import STANDARD_CAMERA, Camera, View, floor, shaded
from sarah.simulation.simulator import Simulator

MARGIN = 0.05
"""Distance around the corners of torso and feet, in m, that contains the whole robot; nothing else is drawn."""
SHOE_MARGIN = 1.2
"""Length and width of a shoe, as multiples of those between its sole contacts."""
NEAR, FAR = 0.05, 10.0
LIGHT = (-1.5, 2.5, 3.0)
"""Direction towards the light, in the world's frame."""


def check_renderer() -> None:
    """Refuse to draw where PyBullet, which draws the pictures, is not installed.

    :raises ConfigurationError: naming how to install it
    """
    if not is_installed("pybullet"):
        raise ConfigurationError(f"pictures of the robot need the package pybullet: {INSTALLATION['pybullet']}")


class Renderer:
    """Draws a robot in any pose with PyBullet's software renderer.

    :param robot: checked robot
    :param samples: samples of the robot along each side of a pixel: 2 gives smooth edges; less than 1 is softer and
        faster, as the time grows with their square
    :raises ConfigurationError: if PyBullet is not installed
    """

    def __init__(self, robot: RobotDescription, samples: float = 2.0) -> None:
        check_renderer()
        self._robot = robot
        self._samples = samples
        self._client = take_client()
        try:
            self._body, self._indices = load_robot(self._client, robot.urdf, robot.standing_height, flags=0)
            self._torso = self._torso_corners()
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

        :param position: position of the torso's centre, in m
        :param orientation: orientation of the torso, as a unit quaternion (x, y, z, w)
        :param joints: positions by joint, in rad and m; other joints stay where they were, at first at zero
        :param width: width of the picture, in pixels
        :param height: height of the picture, in pixels
        :param camera: place and direction of the camera
        :return: uint8 array of shape (height, width, 3)
        """
        client = self._client
        pybullet.resetBasePositionAndOrientation(self._body, position, orientation, physicsClientId=client)
        for name, value in joints.items():
            pybullet.resetJointState(self._body, self._indices[name], value, physicsClientId=client)
        view = View(width, height, camera)
        soles = [self._soles(side) for side in Side]
        torso = [pybullet.multiplyTransforms(position, orientation, corner, (0, 0, 0, 1))[0] for corner in self._torso]
        left, top, right, bottom = rectangle = view.rectangle(np.concatenate((torso, *soles)), MARGIN)
        picture = floor(width, height, camera).copy()
        if left < right and top < bottom:
            shadows = [view.pixels(outline * (1.0, 1.0, 0.0)) - (left, top) for outline in soles]
            behind = shaded(picture[top:bottom, left:right], shadows)
            picture[top:bottom, left:right] = self._over(behind, view, rectangle)
        return picture

    def _torso_corners(self) -> np.ndarray:
        """Corners of a box around the torso, in its frame."""
        shapes = pybullet.getVisualShapeData(self._body, physicsClientId=self._client)
        boxes = [shape for shape in shapes if shape[1] == -1 and shape[2] == pybullet.GEOM_BOX]
        reach = np.max([np.abs(box[5]) + np.array(box[3]) / 2 for box in boxes], axis=0)
        return np.array(list(product((-1, 1), repeat=3))) * reach

    def _soles(self, side: Side) -> np.ndarray:
        """Corners of a foot's sole in the world, in order around it."""
        corners = []
        for plate, order in zip(PLATES, (1, -1), strict=True):
            name = f"{side}_{plate}"
            state = pybullet.getLinkState(
                self._body, self._indices[name], computeForwardKinematics=1, physicsClientId=self._client
            )
            for sole in self._robot.soles[name][::order]:
                corners.append(pybullet.multiplyTransforms(state[4], state[5], sole, (0, 0, 0, 1))[0])
        contacts = np.array(corners)
        middle = contacts.mean(axis=0)
        return np.asarray(middle + SHOE_MARGIN * (contacts - middle))

    def _over(self, behind: np.ndarray, view: View, rectangle: tuple[int, int, int, int]) -> np.ndarray:
        """Draw the robot over a part of the picture."""
        left, top, right, bottom = rectangle
        rotation = view.axes * [[1], [1], [-1]]  # OpenGL looks along its negative z axis
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = rotation, -rotation @ view.position
        scale = NEAR / view.focal_length
        projection = pybullet.computeProjectionMatrix(
            scale * (left - view.width / 2),
            scale * (right - view.width / 2),
            scale * (view.height / 2 - bottom),
            scale * (view.height / 2 - top),
            NEAR,
            FAR,
        )
        columns, rows = round(self._samples * (right - left)), round(self._samples * (bottom - top))
        image = pybullet.getCameraImage(
            columns,
            rows,
            matrix.T.flatten().tolist(),
            projection,
            lightDirection=LIGHT,
            shadow=0,
            lightAmbientCoeff=0.55,
            lightDiffuseCoeff=0.45,
            lightSpecularCoeff=0.1,
            renderer=pybullet.ER_TINY_RENDERER,
            physicsClientId=self._client,
        )
        pixels = np.array(image[2], np.uint8).reshape(rows, columns, 4)
        pixels[..., 3] = 255 * (np.reshape(image[4], (rows, columns)) >= 0)
        robot = Image.fromarray(pixels).resize((right - left, bottom - top), Image.Resampling.BILINEAR)
        picture = Image.fromarray(behind)
        picture.paste(robot, mask=robot)
        return np.asarray(picture)

    def draw_simulator(
        self, simulator: Simulator, width: int = 640, height: int = 480, camera: Camera = STANDARD_CAMERA
    ) -> np.ndarray:
        """Draw a simulator's robot as it stands.

        :param simulator: simulator of any engine
        :param width: width of the picture, in pixels
        :param height: height of the picture, in pixels
        :param camera: place and direction of the camera
        :return: uint8 array of shape (height, width, 3)
        """
        names = ACTUATED_JOINTS + ANKLE_JOINTS
        joints = dict(zip(names, simulator.joint_positions(names), strict=True))
        torso = simulator.torso_state()
        return self.draw(torso.position, torso.orientation, joints, width, height, camera)

    def close(self) -> None:
        """Give PyBullet's client back; the renderer cannot draw after that."""
        if self._client >= 0:
            give_back_client(self._client)
            self._client = -1
