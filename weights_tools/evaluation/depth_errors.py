"""Errors of ranges, weighted by the solid angle of their pixels, by range and latitude."""

from dataclasses import dataclass, field

import numpy as np

from weights_tools.training.sphere import row_weights

# Upper ends of the bins of true range, metres, as in slam/evaluation; farther pixels are ignored.
RANGE_ENDS = (5.0, 10.0, 20.0, 40.0, 80.0)
LATITUDE_BANDS = 6  # of equal height, the lowest first
_KINDS = ("weight", "squared", "absolute", "relative", "within", "inverse_squared", "inverse")
_KILOMETRE = 1000.0  # metres; errors of inverse ranges are in 1/km, as KITTI has them


@dataclass
class DepthErrors:
    """Sums over pixels: range bins x latitude bands x kinds."""

    sums: np.ndarray = field(
        default_factory=lambda: np.zeros((len(RANGE_ENDS), LATITUDE_BANDS, len(_KINDS)))
    )

    def add(self, truth: np.ndarray, estimate: np.ndarray) -> None:
        """Panoramas of one size, metres; truth is 0 where there is no surface."""
        height, width = truth.shape
        rows = np.arange(height)
        weight = np.repeat(row_weights(height)[:, None], width, axis=1)
        band = (height - 1 - rows) * LATITUDE_BANDS // height
        band = np.repeat(band[:, None], width, axis=1)
        known = (truth > 0) & (truth <= RANGE_ENDS[-1])
        truth, estimate = truth[known].astype(float), np.maximum(estimate[known], 1e-3)
        weight = weight[known]
        cell = np.searchsorted(RANGE_ENDS, truth) * LATITUDE_BANDS + band[known]
        error = np.abs(estimate - truth)
        within = np.maximum(estimate / truth, truth / estimate) < 1.25
        inverse = _KILOMETRE * np.abs(1 / estimate - 1 / truth)
        values_of = (1.0, error**2, error, error / truth, within, inverse**2, inverse)
        for i, values in enumerate(values_of):
            counted = np.bincount(cell, weight * values, minlength=self.sums[..., 0].size)
            self.sums[..., i] += counted.reshape(self.sums.shape[:2])

    def __iadd__(self, other: "DepthErrors") -> "DepthErrors":
        self.sums += other.sums
        return self

    def measures(self, range_bin: int | None = None, band: int | None = None) -> dict[str, float]:
        """Errors of all pixels, a bin of range or a band of latitude; NaN without pixels."""
        sums = self.sums if range_bin is None else self.sums[range_bin : range_bin + 1]
        sums = sums if band is None else sums[:, band : band + 1]
        weight, squared, absolute, relative, within, inverse_squared, inverse = sums.sum(axis=(0, 1))
        with np.errstate(invalid="ignore"):
            return {
                "absrel": float(relative / weight),
                "delta1": float(within / weight),
                "rmse": float(np.sqrt(squared / weight)),
                "mae": float(absolute / weight),
                "irmse": float(np.sqrt(inverse_squared / weight)),
                "imae": float(inverse / weight),
            }
