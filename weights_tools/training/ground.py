"""Which pixels show the ground that the height of the camera is measured from.

That is the plane of the road under the camera: not kerbs, slopes farther on or roofs of cars, whose
distance from the camera says nothing about the scale.
"""

import numpy as np

from weights_tools.training.sphere import bearings

# How far off the plane a surface may be: metres, and metres for each metre away from the camera,
# within which the road bends. Kerbs are 0.12 m high.
NEAR, BEND, FARTHEST = 0.04, 0.005, 0.1
# Radius around the camera, metres, in which the plane is fitted; roads bend beyond it.
RADIUS = 8.0


def ground_pixels(ranges: np.ndarray, up: np.ndarray, camera_height: float) -> np.ndarray:
    """height x width, bool. `up` is the world's, in the frame of the camera (-X forward, +Y right,
    +Z up); `camera_height` is in the unit of the ranges. Nothing where there is no such plane."""
    height, width = ranges.shape
    u, v = np.meshgrid(np.arange(width) + 0.5, np.arange(height) + 0.5)
    points = ranges[..., None] * bearings(u, v, height, width)
    axes = np.stack([*_across(up), up])
    x, y, z = np.moveaxis(points @ axes.T, -1, 0)
    away = np.hypot(x, y)
    known = (ranges > 0) & (z < -0.3 * camera_height)

    # z = a x + b y - d, where d is the height of the camera but for its springs.
    near = known & (away < RADIUS)
    columns = np.stack([x[near], y[near], np.full(near.sum(), -1.0)], axis=1)
    solid_angle = np.cos((0.5 - v[near] / height) * np.pi)
    plane = np.array([0, 0, camera_height])
    for tolerance, slope in ((0.3, 0.05), (0.1, 0.01), (NEAR, BEND), (NEAR, BEND)):
        off = np.abs(columns @ plane - z[near])
        inside = off < tolerance + slope * away[near]
        if inside.sum() < 10:
            return np.zeros(ranges.shape, bool)
        weight = np.sqrt(solid_angle[inside])
        rows = columns[inside] * weight[:, None]
        plane = np.linalg.lstsq(rows, z[near][inside] * weight, rcond=None)[0]
    off = np.abs(plane[0] * x + plane[1] * y - plane[2] - z)
    return known & (off < np.minimum(NEAR + BEND * away, FARTHEST))


def _across(up: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors perpendicular to the given one and to each other."""
    first = np.cross(up, [0.0, 1.0, 0.0] if abs(up[1]) < 0.7 else [1.0, 0.0, 0.0])
    first /= np.linalg.norm(first)
    return first, np.cross(up, first)
