"""Pictures of the robot, drawn in a world of their own: the simulated world contains nothing visible."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product
from typing import Any

import numpy as np
from PIL import Image, ImageDraw

from sarah.errors import ConfigurationError
from sarah.robot.description import ANKLE_JOINTS, PLATES, RobotDescription
from sarah.robot.reading import ACTUATED_JOINTS, Side, Vector
from sarah.scenery.bumps import LIGHT
from sarah.scenery.camera import STANDARD_CAMERA, Camera, View
from sarah.scenery.floor import floor, shaded
from sarah.scenery.ground import LEVEL, Ground
from sarah.scenery.push_arrow import arrow, draw_arrow
from sarah.simulation.engines import INSTALLATION, is_installed
from sarah.simulation.pybullet_world import PyBulletWorld, pybullet
from sarah.simulation.simulator import Simulator
from sarah.simulation.world import HoldsWorld

MARGIN = 0.01
"""Margin around the robot's corners, as a share of its height; nothing else is drawn."""
NEAREST = 0.01
"""Smallest distance from the camera at which anything is drawn, in m."""
SIZE = (640, 480)
"""Width and height of a picture, in pixels, unless others are given."""
CUBE = np.array(list(product((-1.0, 1.0), repeat=3)))
FRONT_OF_SOLE, BACK_OF_SOLE = [2, 6], [4, 0]
"""Corners of the cube that are low and in front, from left to right, and low and behind, from right to left."""


def check_renderer() -> None:
    """Refuse to draw where PyBullet, which draws the pictures, is not installed.

    :raises ConfigurationError: naming how to install it
    """
    if not is_installed("pybullet"):
        raise ConfigurationError(f"pictures of the robot need the package pybullet: {INSTALLATION['pybullet']}")


class Renderer(HoldsWorld):
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
        self.camera = STANDARD_CAMERA.scaled(robot.scale.length)
        """Camera for the standing robot, whatever its dimensions."""
        self._world = PyBulletWorld()
        self._client = self._world.client
        try:
            self._body, self._indices = self._world.load_robot(robot.urdf, robot.standing_height, flags=0)
            self._boxes = self._boxes_around_links()
        except BaseException:
            self.close()
            raise

    @np.errstate(under="ignore")  # what is far away is not seen
    def draw(
        self,
        position: Vector,
        orientation: tuple[float, float, float, float],
        joints: Mapping[str, float],
        width: int = SIZE[0],
        height: int = SIZE[1],
        camera: Camera | None = None,
    ) -> np.ndarray:
        """Draw one pose.

        :param position: position of the torso's centre, in m
        :param orientation: orientation of the torso, as a unit quaternion (x, y, z, w)
        :param joints: positions by joint, in rad and m; other joints stay where they were, at first at zero
        :param width: width of the picture, in pixels
        :param height: height of the picture, in pixels
        :param camera: place and direction of the camera; by default the renderer's, stepped back if the pose needs it
        :return: uint8 array of shape (height, width, 3)
        """
        if camera is None:
            camera = self.camera.seeing(self.seen(position, orientation, joints), width, height)
        view = View(width, height, camera)
        boxes = self._boxes_in(position, orientation, joints)
        shadows = [view.pixels(outline) for outline in self._shadows(boxes, camera.ground)]
        picture = shaded(floor(width, height, camera), shadows).copy()
        corners = np.concatenate(list(boxes.values()))
        margin = MARGIN * self._robot.standing_height
        left, top, right, bottom = rectangle = view.rectangle(corners, margin)
        if left < right and top < bottom:
            depths = (corners - view.position) @ view.axes[2]
            picture[top:bottom, left:right] = self._over(
                picture[top:bottom, left:right], view, rectangle, (depths.min(), depths.max())
            )
        return picture

    def seen(
        self,
        position: Vector,
        orientation: tuple[float, float, float, float],
        joints: Mapping[str, float],
        ground: Ground = LEVEL,
        only_feet: bool = False,
    ) -> np.ndarray:
        """Points around all that is drawn of a pose: corners of boxes around the links, and of the feet's shadows.

        :param position: position of the torso's centre, in m
        :param orientation: orientation of the torso, as a unit quaternion (x, y, z, w)
        :param joints: positions by joint, in rad and m; other joints stay where they were, at first at zero
        :param ground: ground that the shadows lie on
        :param only_feet: whether to leave out all links but the shoes
        :return: points in the world's frame, in m, of shape (n, 3)
        :raises SimulationError: if other code in the process has changed the renderer's world
        """
        boxes = self._boxes_in(position, orientation, joints)
        links = [self._indices[name] for name in ANKLE_JOINTS] if only_feet else boxes
        return np.concatenate((*(boxes[link] for link in links), *self._shadows(boxes, ground)))

    def _boxes_in(
        self, position: Vector, orientation: tuple[float, float, float, float], joints: Mapping[str, float]
    ) -> dict[int, np.ndarray]:
        """Corners of boxes around all links in a pose, by link, in the world's frame."""
        self._world.check()
        client = self._client
        pybullet.resetBasePositionAndOrientation(self._body, position, orientation, physicsClientId=client)
        for name, value in joints.items():
            pybullet.resetJointState(self._body, self._indices[name], value, physicsClientId=client)
        boxes = {}
        for link, box in self._boxes.items():
            if link < 0:
                place, turn = position, orientation
            else:
                state = pybullet.getLinkState(self._body, link, computeForwardKinematics=1, physicsClientId=client)
                place, turn = state[4], state[5]
            boxes[link] = _moved(box, place, turn)
        return boxes

    def _shadows(self, boxes: Mapping[int, np.ndarray], ground: Ground) -> list[np.ndarray]:
        """Outline of each foot's shadow: what is under the far ends of its two plates' soles."""
        outlines = []
        for side in Side:
            forefoot, hindfoot = (boxes[self._indices[f"{side}_{plate}"]] for plate in PLATES)
            ends = np.concatenate((forefoot[FRONT_OF_SOLE], hindfoot[BACK_OF_SOLE]))
            outlines.append(np.array([(x, y, ground.height(x, y)) for x, y, _ in ends.tolist()]))
        return outlines

    def _boxes_around_links(self) -> dict[int, np.ndarray]:
        """Corners of a box around the shapes of each link, in the link's frame."""
        shapes: dict[int, list[np.ndarray]] = {}
        for _, link, kind, size, _, place, turn, *_ in pybullet.getVisualShapeData(
            self._body, physicsClientId=self._client
        ):
            half = np.array(size) / 2
            if kind == pybullet.GEOM_CYLINDER:  # length, radius
                half = np.array((size[1], size[1], size[0] / 2))
            elif kind == pybullet.GEOM_SPHERE:
                half = np.full(3, size[0])
            shapes.setdefault(link, []).append(_moved(CUBE * half, place, turn))
        boxes = {}
        for link, corners in shapes.items():
            points = np.concatenate(corners)
            low, high = points.min(axis=0), points.max(axis=0)
            boxes[link] = (low + high) / 2 + CUBE * (high - low) / 2
        return boxes

    def _over(
        self, behind: np.ndarray, view: View, rectangle: tuple[int, int, int, int], depths: tuple[float, float]
    ) -> np.ndarray:
        """Draw the robot, which lies between two distances from the camera, over a part of the picture."""
        left, top, right, bottom = rectangle
        near, far = max(NEAREST, 0.9 * depths[0]), max(2 * NEAREST, 1.1 * depths[1])
        rotation = view.axes * [[1], [1], [-1]]  # OpenGL looks along its negative z axis
        matrix = np.eye(4)
        matrix[:3, :3], matrix[:3, 3] = rotation, -rotation @ view.position
        scale = near / view.focal_length
        projection = pybullet.computeProjectionMatrix(
            scale * (left - view.width / 2),
            scale * (right - view.width / 2),
            scale * (view.height / 2 - bottom),
            scale * (view.height / 2 - top),
            near,
            far,
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

    def draw_simulator(self, simulator: Simulator, force: Vector | None = None) -> np.ndarray:
        """Draw a simulator's robot as it stands, on the simulator's ground.

        :param simulator: simulator of any engine
        :param force: force of a push, which is drawn as an arrow, in N
        :return: uint8 array of shape (480, 640, 3); the ground alone if the simulation has diverged
        """
        torso, camera = simulator.torso_state(), self.camera._replace(ground=simulator.ground)
        if not torso.is_finite:
            return floor(*SIZE, camera).copy()
        names = ACTUATED_JOINTS + ANKLE_JOINTS
        joints = dict(zip(names, simulator.joint_positions(names), strict=True))
        ends = None if force is None else arrow(np.array(torso.position), np.array(force), self._robot.scale)
        seen = self.seen(torso.position, torso.orientation, joints, camera.ground)
        camera = camera.seeing(seen if ends is None else np.concatenate((seen, ends)), *SIZE)
        picture = self.draw(torso.position, torso.orientation, joints, *SIZE, camera)
        if ends is None:
            return picture
        with_arrow = Image.fromarray(picture)
        draw_arrow(ImageDraw.Draw(with_arrow), View(*SIZE, camera), ends)
        return np.asarray(with_arrow)

    def close(self) -> None:
        """Give PyBullet's client back; the renderer cannot draw after that."""
        self._world.close()


def _moved(points: np.ndarray, place: Any, turn: Any) -> np.ndarray:
    """Points in another frame, whose place and orientation are given."""
    rotation = np.reshape(pybullet.getMatrixFromQuaternion(turn), (3, 3))
    return np.asarray(points @ rotation.T + place)
