"""Sparse depth as stereo between views hands it over, simulated from exact ranges.

Stereo measures wherever the image has contrast, up to a point for each pixel, and its errors are
regular: edges of near surfaces grow over what lies behind them, whole patches are matched wrongly,
and neighbouring pixels err alike. What has no contrast, and what is too far for the baseline, stays
unmeasured.
"""

from dataclasses import dataclass

import numpy as np
import torch
import torch.nn.functional as F

from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import SparsePoints, confidence_of, log_uniform, rasterise
from weights_tools.training.sphere import bearings

# The width of the image to which pixels below refer.
_WIDTH = 1024
# Metres that stand for no surface: more than any range and its errors, and finite.
_NOTHING = np.float32(1e9)


@dataclass(frozen=True)
class StereoNoise:
    """The distribution of errors; pairs are drawn evenly in the logarithm, one for each frame."""

    points: tuple[int, int] = (1000, 200_000)  # at most, at a width of 1024
    grid: float = 0.6  # fraction of the frames whose points lie on a regular grid
    contrast: tuple[float, float] = (0.3, 6.0)  # least standard deviation around a pixel, of 255
    disparity: tuple[float, float] = (0.03, 0.3)  # pixels; standard deviation
    baseline: tuple[float, float] = (0.15, 3.0)  # metres between the views
    common: float = 0.5  # fraction of the variance that neighbouring pixels have in common
    largest_error: float = 0.12  # fraction of the range; SLAM hands over nothing less certain
    holes: tuple[float, float] = (0.02, 0.6)  # fraction of the sphere
    fattened: tuple[float, float] = (0.5, 5.0)  # pixels
    wrong: tuple[float, float] = (0.002, 0.05)  # fraction of the sphere matched wrongly, in patches
    sky: tuple[float, float] = (0.001, 0.1)  # fraction of the sky that is measured
    moving_kept: float = 0.3  # fraction of the frames in which moving objects are measured, wrongly
    estimate_error: float = 0.3  # standard deviation of ln of the standard deviation that is stated
    scale: tuple[float, float] = (0.05, 20.0)  # units of the map in a metre


def simulate_stereo(
    frame: Frame, random: np.random.RandomState, model: StereoNoise = StereoNoise()
) -> SparsePoints:
    height, width = frame.range.shape
    scale = float(log_uniform(random, model.scale))
    noise = _Noise(random, (height, width))

    # Edges: the nearest range within some pixels, where patches of noise say so.
    reach = round(float(log_uniform(random, model.fattened)) * width / _WIDTH)
    ranges = np.where(frame.range > 0, frame.range, _NOTHING)
    grown = _nearest_within(ranges, reach)
    surface = np.where(noise.patches(6, 0.5), grown, ranges)
    has_sky = surface == _NOTHING
    distant = float(log_uniform(random, (20.0, 300.0)))  # metres
    surface[has_sky] = distant
    wrong = noise.patches(4, float(log_uniform(random, model.wrong)))
    surface *= np.where(wrong, np.exp(noise.smooth(6)), 1)

    error = _relative_errors(surface, frame.travel, random, model)
    has_contrast = _contrast(frame.rgb) > log_uniform(random, model.contrast)
    usable = has_contrast & (error < model.largest_error)
    usable &= ~noise.patches(random.randint(2, 6), float(log_uniform(random, model.holes)))
    usable &= ~has_sky | noise.patches(4, float(log_uniform(random, model.sky)))
    if random.uniform() >= model.moving_kept:
        usable &= ~frame.moving
    else:
        surface *= np.where(frame.moving, float(np.exp(random.uniform(-0.7, 0.7))), 1)

    rows, columns = _choose(usable, random, model)
    error = error[rows, columns]
    own = random.standard_normal(len(rows))
    common = noise.smooth(5)[rows, columns]
    deviation = np.sqrt(1 - model.common) * own + np.sqrt(model.common) * common
    # Disparity is proportional to the inverse of the range.
    measured = surface[rows, columns] / np.maximum(1 + error * deviation, 0.05)
    stated = error * np.exp(model.estimate_error * random.standard_normal(len(rows)))
    return SparsePoints(
        *rasterise((height, width), rows, columns, scale * measured, confidence_of(stated)), scale
    )


class _Noise:
    """Smooth random images of a mean of 0 and a variance of 1 that continue across the seam."""

    def __init__(self, random: np.random.RandomState, size: tuple[int, int]) -> None:
        self._random, self._size = random, size

    def smooth(self, octave: int) -> np.ndarray:
        """Details have about 1 / 2^octave of the image's height."""
        height, width = self._size
        rows = max(min(2**octave, height // 2), 2)
        coarse = self._random.standard_normal((rows, 2 * rows)).astype(np.float32)
        wide = np.concatenate([coarse, coarse[:, :2]], axis=1)
        step = width / (2 * rows)
        size = (height, round(step * (2 * rows + 2)))
        image = F.interpolate(_planes(wide), size, mode="bicubic", align_corners=False)[0, 0].numpy()
        start = round(step)
        image = image[:, start : start + width]
        return image / image.std()  # interpolation has taken a part of the variance

    def patches(self, octave: int, fraction: float) -> np.ndarray:
        """True on about that fraction of the pixels."""
        image = self.smooth(octave)
        return image > np.quantile(image[::4, ::4], 1 - fraction)


def _contrast(rgb: np.ndarray) -> np.ndarray:
    """Standard deviation of the brightness within 5 x 5 pixels, of 255."""
    gray = rgb @ np.array([0.299, 0.587, 0.114], np.float32)
    planes = _planes(np.stack([gray, gray * gray]))
    mean, squares = F.avg_pool2d(planes, 5, 1, 2, count_include_pad=False)[0].numpy()
    return np.sqrt(np.maximum(squares - mean * mean, 0))


def _nearest_within(ranges: np.ndarray, pixels: int) -> np.ndarray:
    """The least range of a square around each pixel."""
    farther = F.max_pool2d(-_planes(ranges), 2 * pixels + 1, 1, pixels)
    return -farther[0, 0].numpy()


def _planes(image: np.ndarray) -> torch.Tensor:
    """1 x planes x height x width."""
    return torch.from_numpy(np.ascontiguousarray(image)).reshape(1, -1, *image.shape[-2:])


def _relative_errors(
    ranges: np.ndarray, travel: np.ndarray, random: np.random.RandomState, model: StereoNoise
) -> np.ndarray:
    """Standard deviation of each range as a fraction of it: none is known along the baseline."""
    height, width = ranges.shape
    if travel.any() and random.uniform() < 0.8:
        baseline = travel
    else:  # the views lie anywhere
        baseline = random.standard_normal(3)
        baseline /= np.linalg.norm(baseline)
    v, u = np.mgrid[0:height, 0:width] + 0.5
    seen = bearings(u.ravel(), v.ravel(), height, width)
    across = np.sqrt(np.maximum(1 - (seen @ baseline) ** 2, 1e-6)).reshape(height, width)
    pixel = 2 * np.pi / _WIDTH
    metres, pixels = (float(log_uniform(random, pair)) for pair in (model.baseline, model.disparity))
    return (pixels * pixel * ranges / (metres * across)).astype(np.float32)


def _choose(
    usable: np.ndarray, random: np.random.RandomState, model: StereoNoise
) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns of pixels, on a grid or anywhere."""
    height, width = usable.shape
    limit = log_uniform(random, model.points) * (width / _WIDTH) ** 2
    if random.uniform() < model.grid:
        step = max(round(float(np.sqrt(height * width / limit))), 1)
        chosen = np.zeros_like(usable)
        first = random.randint(step, size=2)
        chosen[first[0] :: step, first[1] :: step] = True
        return np.nonzero(usable & chosen)
    flat = np.flatnonzero(usable)
    kept = flat[random.uniform(size=len(flat)) < limit / max(len(flat), 1)]
    return np.unravel_index(kept, usable.shape)
