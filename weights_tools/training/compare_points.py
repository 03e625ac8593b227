"""Compares simulated sparse points with those of SLAM on frames that have both:

    python3 -m weights_tools.training.compare_points SHARD.npz ...
"""

import argparse
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np

from weights_tools.refusal import refusing
from weights_tools.training.batches import Frames
from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import NoiseModel, SparsePoints, from_slam, simulate
from weights_tools.training.stereo_points import simulate_stereo

CONFIDENCES = (0.0, 0.25, 0.5, 0.75, 0.9, 1.0)
RANGES = (0, 5, 10, 20, 40, 80)  # metres
OUTLIER = 0.25  # of |ln(range / truth)|; noise is smaller than this at the confidences that matter

# Where the points of a column come from.
SOURCES: dict[str, Callable[[Frame, np.random.RandomState], SparsePoints]] = {
    "SLAM": lambda frame, random: from_slam(frame, random, NoiseModel(thinned=0)),
    "landmarks": simulate,
    "stereo": simulate_stereo,
}


def errors(
    frames: Frames, give: Callable[[Frame, np.random.RandomState], SparsePoints]
) -> Iterator[np.ndarray]:
    """ln(range / truth), confidence and truth of the points, for each frame with points of SLAM."""
    for i in range(len(frames)):
        frame = frames[i]
        if len(frame.points) == 0:
            continue
        points = give(frame, np.random.RandomState(i))
        known = (points.depth > 0) & (frame.range > 0)
        truth = frame.range[known]
        error = np.log(points.depth[known] / points.scale / truth)
        yield np.stack([error, points.confidence[known], truth])


def summary(parts: list[np.ndarray]) -> dict[str, float]:
    """Counts, errors and their distribution, by name."""
    error, confidence, truth = np.concatenate(parts, axis=1)
    error = np.abs(error)
    result = {
        "points of a frame, median": float(np.median([part.shape[1] for part in parts])),
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
    parts = {name: list(errors(frames, give)) for name, give in SOURCES.items()}
    if not parts["SLAM"]:
        parser.error("no frame has points of SLAM; make the shards with --run")
    summaries = {name: summary(part) for name, part in parts.items()}
    print(" " * 48 + "".join(f"{name:>12}" for name in summaries))
    for name in summaries["SLAM"]:
        print(f"{name:48}" + "".join(f"{values[name]:12.3f}" for values in summaries.values()))


if __name__ == "__main__":
    main()
