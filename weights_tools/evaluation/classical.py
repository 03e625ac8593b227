"""Interpolation of sparse ranges on the sphere without any learning.

Each method gives ranges at every STEP-th pixel in both directions, of a panorama whose points have a
range (metres, 0: none) and a confidence.
"""

from collections.abc import Callable, Mapping

import cv2
import numpy as np

from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import SparsePoints
from weights_tools.training.sphere import bearings, row_weights

STEP = 8  # pixels
RASTER_STEP = 2  # pixels between those that areas are counted in, and that are filtered
NEIGHBOURS = 8  # of inverse-distance weighting
# Radians below which two directions count as one: a tenth of a pixel at 1024 x 512.
CLOSEST = 6e-4
GUIDED_RADIUS = 8  # pixels of the raster
GUIDED_EPSILON = 5.0**2  # of the image's variance, of intensities to 255; with values to 1 OpenCV's
# filter of colour images takes their covariance for singular.

Interpolation = Callable[[Frame, SparsePoints], np.ndarray]


def nearest_neighbour(frame: Frame, points: SparsePoints) -> np.ndarray:
    """The range of the nearest point."""
    return _nearest(points, STEP)[0]


def inverse_distance(frame: Frame, points: SparsePoints) -> np.ndarray:
    """The mean of the eight nearest, weighted by their confidence over the square of their angular
    distance."""
    queries, site, angle = _neighbours(points, STEP, NEIGHBOURS)
    if site is None:
        return np.ones(queries.shape[:2], np.float32)
    weight = points.confidence[points.depth > 0][site] / np.maximum(angle, CLOSEST) ** 2
    mean = (weight * points.depth[points.depth > 0][site]).sum(axis=1) / weight.sum(axis=1)
    return mean.reshape(queries.shape[:2]).astype(np.float32)


def natural_neighbour(frame: Frame, points: SparsePoints) -> np.ndarray:
    """Sibson's interpolation of inverse ranges, which are linear on planes.

    A pixel counts for all queries that are nearer to it than its own point is: those that would take
    it from that point's Voronoi cell (Park et al., "Discrete Sibson Interpolation", 2006).
    """
    height, width = points.depth.shape
    near, angle = _nearest(points, RASTER_STEP)
    raster = _directions(height, width, RASTER_STEP).reshape(-1, 3)
    area = np.repeat(row_weights(len(near)), near.shape[1])
    values = np.stack([area / near.ravel(), area], axis=1).astype(np.float32)
    reach = np.cos(angle.ravel() + 1e-6)
    queries = _directions(height, width, STEP)
    own, _ = _nearest(points, STEP)
    inverse = []
    for row, fallback in zip(queries, own):
        taken = (row @ raster.T >= reach).astype(np.float32) @ values
        is_point = taken[:, 1] == 0  # it lies on a point, and takes nothing
        inverse.append(np.where(is_point, 1 / fallback, taken[:, 0] / np.where(is_point, 1, taken[:, 1])))
    return (1 / np.array(inverse)).astype(np.float32)


def guided_filter(frame: Frame, points: SparsePoints) -> np.ndarray:
    """The nearest points' logarithms of ranges, filtered along the image's edges (He et al., "Guided
    Image Filtering", 2010)."""
    near, _ = _nearest(points, RASTER_STEP)
    image = cv2.resize(frame.rgb, near.shape[::-1], interpolation=cv2.INTER_AREA)
    margin = 2 * GUIDED_RADIUS  # the panorama goes on beyond its left and right edge

    def wrapped(values: np.ndarray) -> np.ndarray:
        return np.hstack([values[:, -margin:], values, values[:, :margin]])

    filtered = cv2.ximgproc.guidedFilter(
        wrapped(image.astype(np.float32)), wrapped(np.log(near)), GUIDED_RADIUS, GUIDED_EPSILON
    )[:, margin:-margin]
    factor = STEP // RASTER_STEP
    return np.exp(filtered[factor // 2 :: factor, factor // 2 :: factor])


METHODS: Mapping[str, Interpolation] = {
    "nearest neighbour": nearest_neighbour,
    "inverse distance": inverse_distance,
    "natural neighbour": natural_neighbour,
    "guided filter": guided_filter,
}


def thinned(image: np.ndarray) -> np.ndarray:
    """The pixels of an image that methods give ranges for."""
    return image[STEP // 2 :: STEP, STEP // 2 :: STEP]


def _directions(height: int, width: int, step: int) -> np.ndarray:
    half = step // 2
    u, v = np.meshgrid(np.arange(half, width, step) + 0.5, np.arange(half, height, step) + 0.5)
    return bearings(u, v, height, width).astype(np.float32)


def _neighbours(
    points: SparsePoints, step: int, count: int
) -> tuple[np.ndarray, np.ndarray | None, np.ndarray | None]:
    """Directions of the queries; the numbers of their nearest points, and the angles to them."""
    height, width = points.depth.shape
    queries = _directions(height, width, step)
    rows, columns = np.nonzero(points.depth > 0)
    if len(rows) == 0:
        return queries, None, None
    sites = bearings(columns + 0.5, rows + 0.5, height, width).astype(np.float32)
    count = min(count, len(sites))
    single_tree = 4  # FLANN's exact search in one k-d tree
    tree = cv2.flann_Index(sites, {"algorithm": single_tree})
    site, squared = tree.knnSearch(queries.reshape(-1, 3), count, params={"checks": -1})
    # The chord between two unit vectors is twice the sine of half their angle.
    angle = 2 * np.arcsin(np.clip(np.sqrt(np.maximum(squared, 0)) / 2, 0, 1))
    return queries, site, angle


def _nearest(points: SparsePoints, step: int) -> tuple[np.ndarray, np.ndarray]:
    """The range of the nearest point and the angle to it; 1 and 0 without points."""
    queries, site, angle = _neighbours(points, step, 1)
    shape = queries.shape[:2]
    if site is None or angle is None:
        return np.ones(shape, np.float32), np.zeros(shape, np.float32)
    return points.depth[points.depth > 0][site].reshape(shape), angle.reshape(shape)
