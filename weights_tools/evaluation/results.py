"""Errors of networks and of classical interpolation on drives, and their summary."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from weights_tools.evaluation import classical
from weights_tools.evaluation.depth_errors import DepthErrors

# The headline figures are means over these numbers of points.
HEADLINE = ("500", "1000", "2000")
OURS, ALONE, PUBLISHED = "depth completion", "propagation alone", "published encoder-decoder"
METHODS = (OURS, PUBLISHED, ALONE, *classical.METHODS)
FUSED = 10  # keyframes


@dataclass
class Scale:
    """Errors of the metric scale in the frames of a drive, in the order of time."""

    plane: list[float] = field(default_factory=list)  # ln of estimated over true scale
    guard: list[float] = field(default_factory=list)


@dataclass
class Result:
    """What was measured on one town or on several."""

    errors: dict[tuple[str, str], DepthErrors] = field(default_factory=dict)
    cuts: list[float] = field(default_factory=list)
    # Pixels drawn at random: expected and observed relative error, solid angle.
    calibration: list[np.ndarray] = field(default_factory=list)
    scales: list[Scale] = field(default_factory=list)

    def of(self, method: str, points: str) -> DepthErrors:
        return self.errors.setdefault((method, points), DepthErrors())

    def __iadd__(self, other: "Result") -> "Result":
        for (method, points), errors in other.errors.items():
            self.of(method, points).__iadd__(errors)
        self.cuts += other.cuts
        self.calibration += other.calibration
        self.scales += other.scales
        return self

    def headline(self, method: str) -> dict[str, float]:
        return self._over(method, HEADLINE).measures()

    def best_classical(self, points: Sequence[str]) -> float:
        """AbsRel of the classical method that is best for these points."""
        return min(self._over(m, points).measures()["absrel"] for m in classical.METHODS)

    def _over(self, method: str, points: Sequence[str]) -> DepthErrors:
        total = DepthErrors()
        for kind in points:
            if (method, kind) in self.errors:
                total += self.errors[method, kind]
        return total

    def summary(self) -> dict[str, float]:
        ours = self.headline(OURS)
        plane = np.abs(np.concatenate([scale.plane for scale in self.scales] or [[]]))
        guard = np.abs(np.concatenate([scale.guard for scale in self.scales] or [[]]))
        fused = np.abs([value for scale in self.scales for value in _fused(scale.plane)])
        return {
            "absrel": ours["absrel"],
            "delta1": ours["delta1"],
            "rmse": ours["rmse"],
            "mae": ours["mae"],
            "absrel_best_classical": self.best_classical(HEADLINE),
            "absrel_propagation": self.headline(ALONE)["absrel"],
            "absrel_published": self.headline(PUBLISHED)["absrel"],
            "scale_median_abs_log": _quantile(plane, 0.5),
            "scale_p95_abs_log": _quantile(plane, 0.95),
            "scale_fused_median_abs_log": _quantile(fused, 0.5),
            "scale_guard_median_abs_log": _quantile(guard, 0.5),
            "rmse_cut_by_dropping_20_percent": float(np.mean(self.cuts)) if self.cuts else np.nan,
        }


def _quantile(values: np.ndarray, fraction: float) -> float:
    values = values[np.isfinite(values)]
    return float(np.quantile(values, fraction)) if len(values) else np.nan


def _fused(logs: Sequence[float]) -> Iterator[float]:
    """Medians over FUSED neighbouring frames, or over fewer where a drive is short."""
    logs = [value for value in logs if np.isfinite(value)]
    for first in range(0, max(len(logs) - FUSED, 0) + 1, FUSED):
        if logs[first : first + FUSED]:
            yield float(np.median(logs[first : first + FUSED]))


def calibration_table(result: Result) -> np.ndarray:
    """Means of the expected and the observed relative error for each decile of the expected one."""
    if not result.calibration:
        return np.zeros((0, 2))
    expected, observed, weight = np.concatenate(result.calibration, axis=1)
    order = np.argsort(expected)
    fraction = np.cumsum(weight[order]) / weight.sum()
    rows = []
    for i in range(10):
        part = order[(fraction > i / 10) & (fraction <= (i + 1) / 10)]
        own = weight[part]
        rows.append([(values[part] * own).sum() / own.sum() for values in (expected, observed)])
    return np.array(rows)


def risk_coverage(result: Result) -> np.ndarray:
    """For each tenth of the solid angle, the most confident first: what is covered up to there, and
    the mean relative error of that."""
    if not result.calibration:
        return np.zeros((0, 2))
    expected, observed, weight = np.concatenate(result.calibration, axis=1)
    order = np.argsort(expected)
    covered = np.cumsum(weight[order])
    risk = np.cumsum((observed * weight)[order]) / covered
    at = np.searchsorted(covered / covered[-1], np.arange(1, 11) / 10 - 1e-9)
    return np.stack([covered[at] / covered[-1], risk[at]], axis=1)
