"""The distance of the ground from the camera, in a completed range picture."""

import numpy as np

from weights_tools.training.sphere import bearings, row_weights

STEP = 4  # pixels from one that is used to the next
LIKELY = 0.5  # probability of ground from which on a pixel counts
ROUNDS = 10  # of reweighting; the plane moves by less than 1e-4 in the last


def distance_of_ground(
    depth: np.ndarray, confidence: np.ndarray, ground: np.ndarray
) -> float | None:
    """Of the plane through the pixels that are likely ground. None where hardly any are.

    The plane is q . p = 1 at a distance of 1 / |q|. An error of p's range by a factor is an error
    of q . p by that factor, wherever p lies: all pixels count by solid angle and confidence.
    """
    height, width = depth.shape
    half = STEP // 2
    u, v = np.meshgrid(np.arange(half, width, STEP) + 0.5, np.arange(half, height, STEP) + 0.5)
    depth, confidence, ground = (
        picture[half::STEP, half::STEP] for picture in (depth, confidence, ground)
    )
    weight = row_weights(height)[half::STEP, None] * confidence * ground
    used = (ground > LIKELY) & (depth > 0)
    if used.sum() < 0.01 * used.size:
        return None
    points = depth[used][:, None] * bearings(u[used], v[used], height, width)
    base = weight[used]
    share = np.ones(len(base))
    for _ in range(ROUNDS):
        rows = points * (base * share)[:, None]
        q = np.linalg.solve(rows.T @ points, rows.sum(axis=0))
        off = np.abs(points @ q - 1)
        # Tukey's weights, at 4.7 standard deviations.
        limit = max(4.7 * 1.48 * np.median(off), 1e-3)
        share = np.where(off < limit, (1 - (off / limit) ** 2) ** 2, 0)
    return float(1 / np.linalg.norm(q))
