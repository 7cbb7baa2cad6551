"""The camera of a picture, and how it projects the world."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sarah.scenery.ground import LEVEL, Ground

BORDER = 0.03
"""Width of the border that a camera leaves around what it must see, as a share of the picture's height."""
NEAREST = 0.2
"""Smallest distance to what a camera must see, as a share of its distance."""


class Camera(NamedTuple):
    """Place of a camera that stands still and looks at a point above the robot's start.

    :param height: height of that point over the floor, in m
    :param distance: distance of the camera from that point, in m
    :param yaw: direction of the view about the floor's normal, in degrees; 180 looks at the robot from its front
    :param pitch: direction of the view over the floor, in degrees; negative looks down
    :param field_of_view: angle of the view from the lower to the upper edge of the picture, in degrees
    :param ground: ground in the picture, whose gravity points down
    """

    height: float = 0.48
    distance: float = 2.0
    yaw: float = 162.0
    pitch: float = -7.0
    field_of_view: float = 35.0
    ground: Ground = LEVEL

    def scaled(self, factor: float) -> Camera:
        """Camera that sees a robot of another size in the same way.

        :param factor: size of the robot, as a multiple of the standard robot's
        """
        return self._replace(height=factor * self.height, distance=factor * self.distance)

    def seeing(self, points: np.ndarray, width: int, height: int) -> Camera:
        """Camera that sees points: this one, or one that has stepped back in the direction of the view.

        :param points: points in the world's frame, in m, of shape (n, 3)
        :param width: width of the picture, in pixels
        :param height: height of the picture, in pixels
        """
        view = View(width, height, self)
        right, up, ahead = view.axes @ (np.asarray(points) - (0.0, 0.0, self.height)).T
        reach = np.array((width / 2, height / 2)) - BORDER * height
        depth = view.focal_length * np.maximum(np.abs(right) / reach[0], np.abs(up) / reach[1])
        needed = np.maximum(depth, NEAREST * self.distance) - ahead
        return self._replace(distance=max(self.distance, float(needed.max())))


STANDARD_CAMERA = Camera()


class View:
    """Projection of the world into the picture of a camera that stands still.

    :param width: width of the picture, in pixels
    :param height: height of the picture, in pixels
    :param camera: place and direction of the camera
    """

    def __init__(self, width: int, height: int, camera: Camera) -> None:
        self.width, self.height = width, height
        self.focal_length = height / 2 / math.tan(math.radians(camera.field_of_view) / 2)
        """Focal length, in pixels."""
        yaw, pitch = math.radians(camera.yaw), math.radians(camera.pitch)
        right = np.array((math.cos(yaw), math.sin(yaw), 0.0))
        ahead = np.array((-math.sin(yaw) * math.cos(pitch), math.cos(yaw) * math.cos(pitch), math.sin(pitch)))
        up = np.cross(right, ahead)
        roll = math.atan2(-right @ camera.ground.gravity, -up @ camera.ground.gravity)
        right, up = math.cos(roll) * right - math.sin(roll) * up, math.cos(roll) * up + math.sin(roll) * right
        self.axes = np.array((right, up, ahead))
        """Unit vectors to the right, upward and ahead, as rows."""
        self.position = np.array((0.0, 0.0, camera.height)) - camera.distance * self.axes[2]

    def pixels(self, points: np.ndarray) -> np.ndarray:
        """Project points of the world into the picture.

        :param points: points in the world's frame and in front of the camera, in m, of shape (n, 3)
        :return: pixels to the right and down from the picture's upper left corner, of shape (n, 2)
        """
        right, up, ahead = self.axes @ (np.asarray(points) - self.position).T
        scale = self.focal_length / ahead
        return np.stack((self.width / 2 + scale * right, self.height / 2 - scale * up), axis=1)

    def rectangle(self, points: np.ndarray, margin: float) -> tuple[int, int, int, int]:
        """Find the part of the picture that contains points of the world.

        :param points: points in the world's frame and in front of the camera, in m, of shape (n, 3)
        :param margin: distance around the points that it contains too, in m
        :return: left, top, right and bottom in pixels, without right and bottom themselves; empty if it is outside
        """
        around = np.concatenate([points + margin * sign * axis for axis in self.axes[:2] for sign in (-1, 1)])
        pixels, corner = self.pixels(around), (self.width, self.height)
        left, top = np.clip(np.floor(pixels.min(axis=0)), 0, corner).astype(int)
        right, bottom = np.clip(np.ceil(pixels.max(axis=0)), 0, corner).astype(int)
        return int(left), int(top), int(right), int(bottom)
