"""Measures a network on packed drives, by kind of world and number of points:

    python3 -m weights_tools.evaluation.evaluate_shards NETWORK SHARD.npz ... [--points 1000 20000 slam]
        [--without TENSOR ...]

NETWORK is a checkpoint of training or a network file; it runs in PyTorch at the size of the shards.
Up to 3,000 points are simulated landmarks, more are simulated stereo; `slam` are the points that
SLAM itself gave, where the shards have them. Ranges up to 80 m count, by solid angle, with the
scale of the points taken as known. What the tensors of --without would tell counts nothing: that
shows how far a trained network relies on them.
"""

import argparse
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from weights_tools import network_file
from weights_tools.ablation import graph_without
from weights_tools.evaluation.given_points import SLAM, points_of
from weights_tools.refusal import refusing
from weights_tools.training.batches import Frames, collate, plain
from weights_tools.training.loss import predicted_depth
from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import SparsePoints
from weights_tools.training.train import checkpoint_network, read_checkpoint
from weights_tools.training.validate import measured_weights
from weights_tools.training.worlds import kind_of

# Outputs of a network by name, of its inputs.
Completes = Callable[[Mapping[str, Tensor]], Mapping[str, Tensor]]

POINTS = ("300", "1000", "3000", "20000", "100000", SLAM)
DECILES = 10
MIN_PIXELS = 1000  # of a frame that counts for the deciles


@dataclass
class Errors:
    """Means over pixels, and over the deciles of the error that the confidence states."""

    absrel: list[float] = field(default_factory=list)
    delta1: list[float] = field(default_factory=list)
    input: list[float] = field(default_factory=list)  # relative error of the points, mean
    count: list[int] = field(default_factory=list)
    stated: list[np.ndarray] = field(default_factory=list)

    def row(self) -> list[str]:
        means = (np.mean(self.absrel), np.mean(self.delta1), np.mean(self.input or [np.nan]))
        return [f"{np.mean(self.count):.0f}", *(f"{mean:.3f}" for mean in means), self._worst()]

    def _worst(self) -> str:
        """Observed over stated error of the deciles, the least and the most."""
        if not self.stated:
            return "–"
        stated, observed = np.mean(self.stated, axis=0)
        return f"{(observed / stated).min():.2f} to {(observed / stated).max():.2f}"


def read_network(path: Path, without: Sequence[str] = ()) -> Completes:
    if path.suffix != ".h5":
        state = read_checkpoint(path, torch.device("cpu"))
        zeroed = " ".join([state["settings"].get("zeroed", ""), *without])
        return checkpoint_network({**state, "settings": {**state["settings"], "zeroed": zeroed}})
    file = network_file.read(path)
    file = file._replace(graph=graph_without(file.graph, without))

    def complete(inputs: Mapping[str, Tensor]) -> dict[str, Tensor]:
        tensors = file.run(inputs)
        return {port["name"]: tensors[port["tensor"]] for port in file.graph.outputs}

    return complete


@torch.no_grad()
def measure(network: Completes, frame: Frame, points: SparsePoints, errors: Errors) -> None:
    batch = collate([plain(frame, points)])
    outputs = network(batch.inputs)
    weight = measured_weights(batch.truth)
    if weight.sum() == 0:
        return
    truth = torch.where(batch.truth > 0, batch.truth, 1.0)
    depth = predicted_depth(outputs)
    relative = (depth - truth).abs() / truth
    within = torch.maximum(depth / truth, truth / depth) < 1.25
    known = (batch.inputs["depth"] > 0) & (weight > 0)

    def mean(values: Tensor, own: Tensor) -> float:
        return ((values * own).sum() / own.sum().clamp(min=1e-9)).item()

    errors.absrel.append(mean(relative, weight))
    errors.delta1.append(mean(within, weight))
    if known.any():
        errors.input.append(mean((batch.inputs["depth"] - truth).abs() / truth, weight * known))
    errors.count.append(int((batch.inputs["depth"] > 0).sum()))
    states_error = "ground" in outputs  # only such a confidence is trained to
    if states_error and (weight > 0).sum() >= MIN_PIXELS:
        stated = 1 / outputs["confidence"].clamp(1e-4, 1 - 1e-4) - 1
        images = (stated, relative, weight)
        errors.stated.append(_deciles(*(image.flatten().numpy() for image in images)))


def _deciles(stated: np.ndarray, relative: np.ndarray, weight: np.ndarray) -> np.ndarray:
    """2 x deciles: means of the stated and the observed error."""
    order = np.argsort(stated)
    order = order[weight[order] > 0]
    fraction = np.cumsum(weight[order]) / weight.sum()
    edges = np.searchsorted(fraction, np.arange(1, DECILES) / DECILES)
    parts = np.split(order, edges)
    return np.array(
        [[np.average(values[part], weights=weight[part]) for part in parts]
         for values in (stated, relative)]
    )  # fmt: skip


def evaluate(
    network: Completes, paths: Sequence[Path], kinds: Sequence[str], every: int
) -> Iterator[tuple[str, str, Errors]]:
    """World, kind of points and errors, world by world."""
    worlds: dict[str, list[Path]] = {}
    for path in paths:
        worlds.setdefault(kind_of(path.stem), []).append(path)
    for world, own in sorted(worlds.items()):
        by_kind = {kind: Errors() for kind in kinds}
        for path in own:
            frames = Frames([path])
            for i in range(0, len(frames), every):
                for kind, errors in by_kind.items():
                    points = points_of(frames[i], kind, i)
                    if points is not None:
                        measure(network, frames[i], points, errors)
        yield from ((world, kind, errors) for kind, errors in by_kind.items() if errors.absrel)


@refusing("evaluate_shards")
def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("network", type=Path)
    parser.add_argument("shards", type=Path, nargs="+")
    parser.add_argument("--points", nargs="+", default=POINTS, help="numbers of them, or slam")
    parser.add_argument("--every", type=int, default=1, help="of that many frames one is used")
    parser.add_argument("--without", nargs="+", default=(), metavar="TENSOR",
                        help="as `orb360 weights inspect` names them")  # fmt: skip
    arguments = parser.parse_args()
    network = read_network(arguments.network, arguments.without)
    print("| world | points | given | AbsRel | within 1.25 | error of the points | observed / stated |")
    print("|---|---|---:|---:|---:|---:|---:|")
    results = evaluate(network, arguments.shards, arguments.points, arguments.every)
    for world, kind, errors in results:
        print("| " + " | ".join([world, kind, *errors.row()]) + " |", flush=True)


if __name__ == "__main__":
    main()
