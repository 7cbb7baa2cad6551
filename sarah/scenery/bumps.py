"""Rough ground in pictures: the same triangles as the engines have."""

from __future__ import annotations

import numpy as np
from PIL import Image, ImageDraw

from sarah.scenery.camera import View
from sarah.scenery.ground import Ground

LIGHT = (-1.5, 2.5, 3.0)
"""Direction towards the light in pictures, in the world's frame."""
CONTRAST = 0.6
"""Change of brightness from a triangle across the light to one along it."""
NEAREST = 0.05
"""Smallest distance from the camera at which a triangle is drawn, in m."""


def mesh(ground: Ground) -> tuple[np.ndarray, np.ndarray]:
    """Nodes and triangles of rough ground.

    :param ground: rough ground
    :return: places of the nodes, in m, of shape (n, 3), and the nodes of each triangle, counter-clockwise seen from
        above, of shape (m, 3)
    """
    count = len(ground.heights)
    places = ground.cell * (np.arange(count) - (count - 1) / 2)
    x, y = np.meshgrid(places, places)
    nodes = np.stack((x, y, np.array(ground.heights)), axis=-1).reshape(-1, 3)
    first = (np.arange(count - 1)[:, None] * count + np.arange(count - 1)).ravel()
    right, ahead, across = first + 1, first + count, first + count + 1
    triangles = np.concatenate((np.stack((first, right, ahead), 1), np.stack((across, ahead, right), 1)))
    return nodes, triangles


def over(picture: np.ndarray, view: View, ground: Ground, colours: np.ndarray, samples: int) -> np.ndarray:
    """Draw bumps over a picture of an even floor, the far ones first.

    :param picture: uint8 array of shape (height, width, 3)
    :param view: projection of the picture
    :param ground: rough ground
    :param colours: colour of each triangle if it were even, from 0 to 255, of shape (triangles, 3)
    :param samples: samples along each side of a pixel
    :return: uint8 array of the same shape
    """
    nodes, triangles = mesh(ground)
    corners = nodes[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    light = np.array(LIGHT) / np.linalg.norm(LIGHT)
    shaded = np.clip(colours * (1.0 + CONTRAST * (normals @ light - light[2]))[:, None], 0, 255).astype(int)
    depths = (corners - view.position) @ view.axes[2]
    order = np.argsort(-depths.mean(axis=1))
    order = order[depths.min(axis=1)[order] > NEAREST]
    outlines = samples * view.pixels(corners[order].reshape(-1, 3)).reshape(-1, 3, 2)
    layer = Image.new("RGBA", (samples * view.width, samples * view.height))
    draw = ImageDraw.Draw(layer)
    for outline, colour in zip(outlines, shaded[order], strict=True):
        draw.polygon([tuple(corner) for corner in outline], fill=(*colour, 255))
    even = Image.fromarray(picture)
    small = layer.resize(even.size, Image.Resampling.BOX)
    even.paste(small, mask=small)
    return np.asarray(even)
