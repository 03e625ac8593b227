"""Sparse depth as SLAM hands it over, simulated from exact ranges.

A landmark is triangulated from places that lie apart along the camera's way. Its range error is the
noise of its corner over the parallax: it grows with the range, and towards the direction of travel.
The confidence is what slam/depth makes of its own estimate of that error.
"""

from dataclasses import dataclass

import numpy as np

from weights_tools.training.shards import Frame
from weights_tools.training.sphere import bearings


# The relative error that makes a confidence of 1/2, as SparseDepthOptions has it.
HALF_CONFIDENCE_ERROR = 0.1


@dataclass(frozen=True)
class NoiseModel:
    """The distribution of errors. The defaults resemble those of SLAM (compare_points), with a
    little more noise."""

    points: tuple[int, int] = (100, 3000)  # drawn evenly in the logarithm, like all pairs below
    # Metres between the places that see a landmark 10 m away; it grows with the square root of the
    # range, as far landmarks stay in sight for longer.
    baseline: tuple[float, float] = (1.5, 16.0)
    observations: tuple[int, int] = (2, 12)  # observations of a landmark
    scale: tuple[float, float] = (0.05, 20.0)  # units of the map in a metre
    noise: tuple[float, float] = (0.7, 2.5)  # factor on the corners' noise, one for each frame
    largest_error: float = 0.2  # fraction of the range; SLAM makes no landmarks of less parallax
    min_confidence: float = 0.5  # as SparseDepthOptions has it
    estimate_bias: float = 0.4  # of the error that SLAM estimates; its estimates are too small
    estimate_error: float = 0.3  # standard deviation of ln of that
    outliers: float = 0.05  # fraction of points matched wrongly, anywhere
    edge_outliers: float = 0.5  # fraction of those near an occlusion edge with any range beside them
    moving_kept: float = 0.4  # fraction of the points on moving objects that SLAM does not drop
    from_slam: float = 0.5  # of frames with points of SLAM itself, the fraction that uses them
    from_stereo: float = 0.5  # of the other frames, the fraction with points of stereo
    thinned: float = 0.5  # of the frames with points of SLAM, the fraction that keeps only a part
    part: tuple[float, float] = (0.02, 1.0)  # of these frames' points


@dataclass(frozen=True)
class SparsePoints:
    depth: np.ndarray  # height x width, float32, units of the map; 0 where there is none
    confidence: np.ndarray  # height x width, float32, in 0..1
    scale: float  # units of the map in a metre


def from_slam(
    frame: Frame, random: np.random.RandomState, model: NoiseModel = NoiseModel()
) -> SparsePoints:
    """The points that SLAM gave for the frame, in a random scale."""
    scale = float(log_uniform(random, model.scale))
    points = frame.points
    if random.uniform() < model.thinned:
        points = points[random.uniform(size=len(points)) < log_uniform(random, model.part)]
    rows, columns = points[:, :2].astype(int).T
    metres, confidence = points[:, 2:].T
    return SparsePoints(
        *rasterise(frame.range.shape, rows, columns, scale * metres, confidence), scale
    )


def simulate(
    frame: Frame, random: np.random.RandomState, model: NoiseModel = NoiseModel()
) -> SparsePoints:
    height, width = frame.range.shape
    u, v, sigma = frame.features.T
    columns = np.minimum(u.astype(int), width - 1)
    rows = np.minimum(v.astype(int), height - 1)
    ranges = frame.range[rows, columns].astype(float)
    seen = bearings(u, v, height, width)

    sigma = sigma * log_uniform(random, model.noise)
    error = _range_errors(ranges, seen, sigma, frame.travel, random, model)
    estimated = error * model.estimate_bias
    estimated *= np.exp(model.estimate_error * random.standard_normal(len(u)))
    confidence = confidence_of(estimated)

    moving = frame.moving[rows, columns]
    usable = (ranges > 0) & (error < model.largest_error) & (confidence >= model.min_confidence)
    usable &= ~moving | (random.uniform(size=len(u)) < model.moving_kept)
    chosen = _choose(np.flatnonzero(usable), seen, random, model)

    rows, columns = rows[chosen], columns[chosen]
    reach = 2 * frame.features[chosen, 2] * width / (2 * np.pi)  # two standard deviations
    error, confidence = error[chosen], confidence[chosen]
    measured = ranges[chosen]
    at_edge = random.uniform(size=len(chosen)) < model.edge_outliers
    measured = np.where(at_edge, _beside(frame.range, rows, columns, reach, random), measured)
    # Triangulation is regular in the inverse of the range.
    inverse = (1 + error * random.standard_normal(len(chosen))) / measured
    measured = 1 / np.maximum(inverse, 1e-3)  # at most a kilometre
    wrong = moving[chosen] | (random.uniform(size=len(chosen)) < model.outliers)
    measured *= np.where(wrong, np.exp(random.uniform(-1, 1, len(chosen))), 1)

    scale = log_uniform(random, model.scale)
    return SparsePoints(
        *rasterise((height, width), rows, columns, scale * measured, confidence), float(scale)
    )


def confidence_of(error: np.ndarray) -> np.ndarray:
    """The confidence of points whose ranges have that relative standard deviation."""
    return 1 / (1 + (error / HALF_CONFIDENCE_ERROR) ** 2)


def log_uniform(
    random: np.random.RandomState, limits: tuple[float, float], size: int | None = None
) -> np.ndarray:
    return np.exp(random.uniform(np.log(limits[0]), np.log(limits[1]), size))


def _range_errors(
    ranges: np.ndarray,
    seen: np.ndarray,
    sigma: np.ndarray,
    travel: np.ndarray,
    random: np.random.RandomState,
    model: NoiseModel,
) -> np.ndarray:
    """Relative standard deviation of each range, as RangeError of slam/depth computes it."""
    if not travel.any():  # it moved before
        travel = random.standard_normal(3)
        travel /= np.linalg.norm(travel)
    across = np.linalg.norm(np.cross(seen, travel), axis=1)
    ranges = np.maximum(ranges, 1e-3)
    baseline = log_uniform(random, model.baseline, len(ranges)) * np.sqrt(ranges / 10)
    parallax = np.arctan2(baseline * across, ranges)
    count = random.randint(model.observations[0], model.observations[1] + 1, len(ranges))
    return np.sqrt(2 / count) * sigma / np.maximum(np.sin(parallax), 1e-9)


def _choose(
    usable: np.ndarray, seen: np.ndarray, random: np.random.RandomState, model: NoiseModel
) -> np.ndarray:
    """Selects points in clusters, because the quality of texture and tracking varies locally."""
    count = min(int(log_uniform(random, model.points)), len(usable))
    if count == 0:
        return usable[:0]
    centres = seen[random.choice(usable, random.randint(3, 13))]
    widths = random.uniform(0.1, 0.6, len(centres))  # radians
    squared_angle = 2 - 2 * np.clip(seen[usable] @ centres.T, -1, 1)
    weight = 0.05 + np.exp(-squared_angle / (2 * widths**2)).sum(axis=1)
    return random.choice(usable, count, replace=False, p=weight / weight.sum())


def _beside(
    ranges: np.ndarray,
    rows: np.ndarray,
    columns: np.ndarray,
    reach: np.ndarray,
    random: np.random.RandomState,
) -> np.ndarray:
    """The range up to `reach` pixels away, which differs near edges only; the own range where that is
    sky. A corner of a coarse level lies farther from what it was found at."""
    height, width = ranges.shape
    shift = np.round(reach * random.uniform(-1, 1, (2, len(rows)))).astype(int)
    there = ranges[np.clip(rows + shift[0], 0, height - 1), (columns + shift[1]) % width]
    return np.where(there > 0, there, ranges[rows, columns]).astype(float)


def rasterise(
    size: tuple[int, int],
    rows: np.ndarray,
    columns: np.ndarray,
    depths: np.ndarray,
    confidences: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Draws the points into an image; the nearest of several at one pixel is kept."""
    depth, confidence = np.zeros(size, np.float32), np.zeros(size, np.float32)
    order = np.argsort(-depths, kind="stable")
    depth[rows[order], columns[order]] = depths[order]
    confidence[rows[order], columns[order]] = confidences[order]
    return depth, confidence
