"""Tells which pixels the error of a network comes from, by kind of world and number of points:

    python3 -m weights_tools.evaluation.error_parts NETWORK SHARD.npz ... [--points 1000 20000]

Each pixel belongs to the first of these parts that it is in: moving objects; edges, where the ranges
within two pixels differ by a factor of at least 1.25; the surroundings of points, up to four pixels
from one; and the rest. Printed are the fraction of the solid angle, the mean relative error there,
and the product of both, which sums up to AbsRel. Ranges up to 80 m count, as in evaluate_shards.
"""

import argparse
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from weights_tools.evaluation.evaluate_shards import Completes, read_network
from weights_tools.evaluation.given_points import points_of
from weights_tools.refusal import refusing
from weights_tools.training.batches import Frames, collate, plain
from weights_tools.training.loss import predicted_depth
from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import SparsePoints
from weights_tools.training.validate import measured_weights
from weights_tools.training.worlds import kind_of

PARTS = ("moving objects", "edges", "near points", "elsewhere")
EDGE_RATIO, EDGE_REACH, POINT_REACH = 1.25, 2, 4  # a factor of range, and pixels


def parts_of(truth: Tensor, moving: Tensor, depth: Tensor) -> list[Tensor]:
    """A mask of 1 x 1 x height x width for each of PARTS. No surface counts as infinitely far."""
    ranges = torch.where(truth > 0, truth, torch.inf)
    nearest = -_largest(-ranges, EDGE_REACH)
    edges = _largest(ranges, EDGE_REACH) > EDGE_RATIO * nearest
    near = _largest((depth > 0).float(), POINT_REACH) > 0
    rest = ~moving
    parts = []
    for mask in (moving, edges, near, torch.ones_like(moving)):
        parts.append(mask if mask is moving else mask & rest)
        rest = rest & ~mask
    return parts


def _largest(image: Tensor, reach: int) -> Tensor:
    return F.max_pool2d(image, 2 * reach + 1, 1, reach)


@torch.no_grad()
def measure(network: Completes, frame: Frame, points: SparsePoints) -> np.ndarray | None:
    """2 x parts: solid angle and its product with the error, as fractions of the solid angle of all
    pixels; None where no surface is near enough."""
    batch = collate([plain(frame, points)])
    weight = measured_weights(batch.truth)
    if weight.sum() == 0:
        return None
    truth = torch.where(batch.truth > 0, batch.truth, 1.0)
    error = (predicted_depth(network(batch.inputs)) / batch.scale / truth - 1).abs()
    moving = torch.from_numpy(frame.moving)[None, None]
    masks = parts_of(batch.truth, moving, batch.inputs["depth"])
    sums = [[(weight * mask).sum(), (weight * mask * error).sum()] for mask in masks]
    return (torch.tensor(sums).T / weight.sum()).numpy()


def evaluate(
    network: Completes, paths: Sequence[Path], kinds: Sequence[str], every: int
) -> Iterator[tuple[str, str, np.ndarray]]:
    """World, kind of points and the mean of `measure`, world by world."""
    found: dict[tuple[str, str], list[np.ndarray]] = {}
    for path in paths:
        frames = Frames([path])
        for i in range(0, len(frames), every):
            for kind in kinds:
                points = points_of(frames[i], kind, i)
                measured = None if points is None else measure(network, frames[i], points)
                if measured is not None:
                    found.setdefault((kind_of(path.stem), kind), []).append(measured)
    for (world, kind), all_measured in sorted(found.items()):
        yield world, kind, np.mean(all_measured, axis=0)


@refusing("error_parts")
def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("network", type=Path)
    parser.add_argument("shards", type=Path, nargs="+")
    parser.add_argument("--points", nargs="+", default=("1000", "20000"), help="numbers, or slam")
    parser.add_argument("--every", type=int, default=1, help="of that many frames one is used")
    arguments = parser.parse_args()
    network = read_network(arguments.network)
    results = list(evaluate(network, arguments.shards, arguments.points, arguments.every))
    print("| world | points | part | solid angle | AbsRel there | of AbsRel |")
    print("|---|---|---|---:|---:|---:|")
    for world, kind, (weights, errors) in results:
        for part, weight, error in zip(PARTS, weights, errors):
            inside = f"{error / weight:.3f}" if weight > 0 else "–"
            print(f"| {world} | {kind} | {part} | {weight:.3f} | {inside} | {error:.4f} |")


if __name__ == "__main__":
    main()
