"""The floor in pictures: its tiles, its bumps, and the feet's shadows on it."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from PIL import Image, ImageDraw, ImageFilter

from sarah.scenery.bumps import mesh, over
from sarah.scenery.camera import Camera, View

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
"""Samples of the floor and of its shadows along each side of a pixel."""
BAND = 32
"""Number of rows of samples of the floor that are drawn at a time."""


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
    colours = np.empty((SAMPLES * height, SAMPLES * width, 3), dtype=np.uint8)
    for top in range(0, len(up), BAND):  # bands stay in the processor's cache
        band = slice(top, top + BAND)
        ray_x, ray_y, ray_z = (right * view.axes[0, i] + up[band] * view.axes[1, i] + view.axes[2, i] for i in range(3))
        length = view.position[2] / np.maximum(-ray_z, 1e-6)  # length of the ray down to the floor
        colours[band] = _colours(length * ray_x + view.position[0], length * ray_y + view.position[1], view, camera)
    picture = np.asarray(Image.fromarray(colours).resize((width, height), Image.Resampling.BOX))
    if camera.ground.is_rough:
        nodes, triangles = mesh(camera.ground)
        x, y, _ = nodes[triangles].mean(axis=1).T
        picture = over(picture, view, camera.ground, _colours(x, y, view, camera), SAMPLES)
    picture.flags.writeable = False
    return picture


def _colours(x: np.ndarray, y: np.ndarray, view: View, camera: Camera) -> np.ndarray:
    """Colours of places of the floor: those of light and dark tiles, which fade into the sky."""
    distance = (x - view.position[0]) ** 2 + (y - view.position[1]) ** 2
    nearness = np.exp(-distance / max(FADING_DISTANCE, FADING_SHARE * camera.distance) ** 2)
    is_dark = (np.floor(x / TILE) + np.floor(y / TILE)) % 2 == 1
    return SKY + nearness[..., None] * (np.where(is_dark[..., None], DARK_TILE, LIGHT_TILE) - SKY)


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
    mask = Image.new("L", (SAMPLES * (right - left), SAMPLES * (bottom - top)))
    draw = ImageDraw.Draw(mask)
    for outline in outlines:
        draw.polygon([tuple(corner) for corner in SAMPLES * (outline - (left, top))], fill=round(255 * SHADOW))
    light = 255 - np.asarray(mask.reduce(SAMPLES).filter(ImageFilter.GaussianBlur(blur)), dtype=np.uint16)
    dark = picture.copy()
    dark[top:bottom, left:right] = dark[top:bottom, left:right] * light[..., None] // 255
    return dark
