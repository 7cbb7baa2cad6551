"""The surroundings of the robot in a picture: the camera's view, a tiled floor, and the feet's shadows on it."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from sarah.simulation.bumps import mesh, over
from sarah.simulation.ground import LEVEL, Ground

TILE = 0.25
"""Length of the floor's tiles, in m; a torso that moves by one tile from its start has left the episode's box."""
LIGHT_TILE, DARK_TILE = np.array((243.0, 245.0, 247.0)), np.array((214.0, 221.0, 229.0))
SKY = np.array((252.0, 252.0, 253.0))
FADING_DISTANCE = 3.0
"""Distance from the camera over which the floor fades to 1/e into the sky, in m; larger for cameras far away."""
FADING_SHARE = 1.3
"""Least fading distance, as a multiple of the camera's distance."""
SHADOW = 0.45
"""Share of the light that a shadow takes."""
SHADOW_BLUR = 0.004
"""Blur of the shadows, as a share of the picture's height."""
SAMPLES = 2
"""Samples of the floor along each side of a pixel."""
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


@lru_cache(maxsize=4)
def floor(width: int, height: int, camera: Camera) -> np.ndarray:
    """Draw the tiled floor, which fades into the sky.

    :param width: width of the picture, in pixels
    :param height: height of the picture, in pixels
    :param camera: place and direction of the camera
    :return: uint8 array of shape (height, width, 3) that must not be changed
    """
    view = View(width, height, camera)
    right = ((np.arange(SAMPLES * width) + 0.5) / SAMPLES - width / 2) / view.focal_length
    up = (height / 2 - (np.arange(SAMPLES * height) + 0.5) / SAMPLES)[:, None] / view.focal_length
    ray_x, ray_y, ray_z = (right * view.axes[0, i] + up * view.axes[1, i] + view.axes[2, i] for i in range(3))
    length = view.position[2] / np.maximum(-ray_z, 1e-6)  # length of the ray down to the floor
    x, y = length * ray_x, length * ray_y
    nearness, is_dark = _tiles(x + view.position[0], y + view.position[1], view, camera)
    shape = (height, SAMPLES, width, SAMPLES)
    light, dark = ((nearness * tile).reshape(shape).mean(axis=(1, 3))[..., None] for tile in (1.0 - is_dark, is_dark))
    picture = _coloured(light, dark).astype(np.uint8)
    if camera.ground.is_rough:
        nodes, triangles = mesh(camera.ground)
        x, y, _ = nodes[triangles].mean(axis=1).T
        nearness, is_dark = (values[:, None] for values in _tiles(x, y, view, camera))
        picture = over(picture, view, camera.ground, _coloured(nearness * (1.0 - is_dark), nearness * is_dark), SAMPLES)
    picture.flags.writeable = False
    return picture


def _tiles(x: np.ndarray, y: np.ndarray, view: View, camera: Camera) -> tuple[np.ndarray, np.ndarray]:
    """Visibility of places of the floor, from 0 to 1, and whether they are on dark tiles."""
    distance = (x - view.position[0]) ** 2 + (y - view.position[1]) ** 2
    nearness = np.exp(-distance / max(FADING_DISTANCE, FADING_SHARE * camera.distance) ** 2)
    return nearness, (np.floor(x / TILE) + np.floor(y / TILE)) % 2


def _coloured(light: np.ndarray, dark: np.ndarray) -> np.ndarray:
    """Colours of the floor where light and dark tiles have these shares of a pixel, and the sky the rest."""
    colours: np.ndarray = SKY + light * (LIGHT_TILE - SKY) + dark * (DARK_TILE - SKY)
    return colours


def shaded(picture: np.ndarray, outlines: list[np.ndarray]) -> np.ndarray:
    """Darken the parts of a picture that lie in shadow.

    :param picture: uint8 array of shape (height, width, 3)
    :param outlines: outlines of the shadows, in pixels, each of shape (corners, 2)
    :return: uint8 array of the same shape
    """
    height, width, _ = picture.shape
    blur = SHADOW_BLUR * height
    corners = np.concatenate(outlines)
    left, top = np.clip(np.floor(corners.min(axis=0) - 3 * blur), 0, (width, height)).astype(int)
    right, bottom = np.clip(np.ceil(corners.max(axis=0) + 3 * blur), 0, (width, height)).astype(int)
    if left >= right or top >= bottom:
        return picture
    mask = Image.new("L", (right - left, bottom - top))
    draw = ImageDraw.Draw(mask)
    for outline in outlines:
        draw.polygon([tuple(corner) for corner in outline - (left, top)], fill=round(255 * SHADOW))
    light = 255 - np.asarray(mask.filter(ImageFilter.GaussianBlur(blur)), dtype=np.uint16)
    dark = picture.copy()
    dark[top:bottom, left:right] = dark[top:bottom, left:right] * light[..., None] // 255
    return dark
