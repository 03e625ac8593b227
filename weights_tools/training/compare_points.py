"""Compares simulated sparse points with those of SLAM on frames that have both:

    python3 -m weights_tools.training.compare_points SHARD.npz ...
"""

import argparse
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from weights_tools.refusal import refusing
from weights_tools.training.batches import Frames
from weights_tools.training.shards import Frame
from weights_tools.training.sphere import bearings
from weights_tools.training.sparse_points import NoiseModel, SparsePoints, from_slam, simulate
from weights_tools.training.stereo_points import simulate_stereo

CONFIDENCES = (0.0, 0.25, 0.5, 0.75, 0.9, 1.0)
RANGES = (0, 5, 10, 20, 40, 80)  # metres
DIRECTIONS = 2000  # from which gaps are measured: about 4 degrees apart
OUTLIER = 0.25  # of |ln(range / truth)|; noise is smaller than this at the confidences that matter

Source = Callable[[Frame, np.random.RandomState], SparsePoints]


def as_many_landmarks(frame: Frame, random: np.random.RandomState) -> SparsePoints:
    """As many simulated landmarks as SLAM has points in that frame, if it has so many corners."""
    count = len(frame.points)
    return simulate(frame, random, NoiseModel(points=(count, count + 0.5)))


# Where the points of a column come from.
SOURCES: dict[str, Source] = {
    "SLAM": lambda frame, random: from_slam(frame, random, NoiseModel(thinned=0)),
    "landmarks": as_many_landmarks,
    "stereo": simulate_stereo,
}


@dataclass(frozen=True)
class Compared:
    """Points of one frame on known surfaces, and how far directions are from the next point."""

    error: np.ndarray  # ln(range / truth)
    confidence: np.ndarray
    truth: np.ndarray  # metres
    gaps: np.ndarray  # degrees, from directions spread evenly over the sphere


def compare(frames: Frames, give: Source) -> Iterator[Compared]:
    """The points of each frame that has points of SLAM."""
    for i in range(len(frames)):
        frame = frames[i]
        if len(frame.points) == 0:
            continue
        points = give(frame, np.random.RandomState(i))
        known = (points.depth > 0) & (frame.range > 0)
        truth = frame.range[known]
        error = np.log(points.depth[known] / points.scale / truth)
        yield Compared(error, points.confidence[known], truth, gaps(points.depth > 0))


def gaps(chosen: np.ndarray) -> np.ndarray:
    """Angles in degrees between directions spread evenly over the sphere and the nearest chosen pixel of an
    image; 180 where none is chosen."""
    v, u = np.nonzero(chosen)
    if len(v) == 0:
        return np.full(DIRECTIONS, 180.0)
    # A spiral on which each direction has the same solid angle (Fibonacci lattice).
    index = np.arange(DIRECTIONS) + 0.5
    longitude = np.pi * (1 + np.sqrt(5)) * index
    z = 1 - 2 * index / DIRECTIONS
    radius = np.sqrt(1 - z * z)
    directions = np.stack([radius * np.cos(longitude), radius * np.sin(longitude), z], axis=1)
    cosine = (directions @ bearings(u + 0.5, v + 0.5, *chosen.shape).T).max(axis=1)
    return np.degrees(np.arccos(np.clip(cosine, -1, 1)))


def summary(parts: list[Compared]) -> dict[str, float]:
    """Counts, errors and their distribution, by name."""
    error = np.abs(np.concatenate([part.error for part in parts]))
    confidence = np.concatenate([part.confidence for part in parts])
    truth = np.concatenate([part.truth for part in parts])
    gap = np.concatenate([part.gaps for part in parts])
    result = {
        "points of a frame, median": float(np.median([len(part.error) for part in parts])),
        "degrees to the nearest point, mean": float(gap.mean()),
        "degrees to the nearest point, 90th percentile": float(np.percentile(gap, 90)),
        "|ln error|, median": float(np.median(error)),
        "|ln error|, 90th percentile": float(np.percentile(error, 90)),
        f"fraction with |ln error| > {OUTLIER}": float((error > OUTLIER).mean()),
    }
    spreads = (("confidence", confidence, CONFIDENCES), ("metres", truth, RANGES))
    for name, values, limits in spreads:
        for low, high in zip(limits, limits[1:]):
            inside = (values > low) & (values <= high)
            result[f"{name} {low} to {high}: fraction"] = float(inside.mean())
            median = np.median(error[inside]) if inside.any() else np.nan
            result[f"{name} {low} to {high}: |ln error|, median"] = float(median)
    return result


@refusing("compare_points")
def main() -> None:
    parser = argparse.ArgumentParser(description="Compares simulated points with those of SLAM.")
    parser.add_argument("shards", type=Path, nargs="+", help="made with --run")
    frames = Frames(parser.parse_args().shards)
    parts = {name: list(compare(frames, give)) for name, give in SOURCES.items()}
    if not parts["SLAM"]:
        parser.error("no frame has points of SLAM; make the shards with --run")
    summaries = {name: summary(part) for name, part in parts.items()}
    print(" " * 48 + "".join(f"{name:>12}" for name in summaries))
    for name in summaries["SLAM"]:
        print(f"{name:48}" + "".join(f"{values[name]:12.3f}" for values in summaries.values()))


if __name__ == "__main__":
    main()
