"""Interpolation of sparse ranges on the sphere without any learning."""

import numpy as np

from weights_tools.training.sphere import bearings

NEIGHBOURS = 8  # of inverse-distance weighting
# Radians below which two directions count as one: a tenth of a pixel at 1024 x 512.
CLOSEST = 6e-4


def interpolate(
    depth: np.ndarray, confidence: np.ndarray, step: int
) -> tuple[np.ndarray, np.ndarray]:
    """The nearest point's range, and the mean of the eight nearest, weighted by their confidence
    over the square of their angular distance, for every `step`-th pixel in both directions."""
    height, width = depth.shape
    rows, columns = np.nonzero(depth > 0)
    count = min(NEIGHBOURS, len(rows))
    half = step // 2
    u, v = np.meshgrid(np.arange(half, width, step) + 0.5, np.arange(half, height, step) + 0.5)
    if count == 0:
        return np.ones(u.shape, np.float32), np.ones(u.shape, np.float32)
    points = bearings(columns + 0.5, rows + 0.5, height, width).astype(np.float32)
    ranges, certain = depth[rows, columns], confidence[rows, columns]
    nearest, weighted = np.empty(u.shape, np.float32), np.empty(u.shape, np.float32)
    for i, queries in enumerate(bearings(u, v, height, width).astype(np.float32)):
        cosine = queries @ points.T
        near = np.argpartition(-cosine, count - 1, axis=1)[:, :count]
        angle = np.arccos(np.clip(np.take_along_axis(cosine, near, 1), -1, 1))
        first = np.take_along_axis(near, angle.argmin(axis=1)[:, None], 1)[:, 0]
        weight = certain[near] / np.maximum(angle, CLOSEST) ** 2
        nearest[i] = ranges[first]
        weighted[i] = (weight * ranges[near]).sum(axis=1) / weight.sum(axis=1)
    return nearest, weighted
