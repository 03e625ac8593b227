"""Errors of a network on frames that it was not trained on."""

from collections.abc import Iterator, Mapping
from dataclasses import replace

import numpy as np
import torch
from torch import Tensor

from weights_tools.network import Network
from weights_tools.training.batches import Batch, Frames, collate, plain
from weights_tools.training.loss import pixel_weights, predicted_depth
from weights_tools.training.sparse_points import NoiseModel, simulate

_FARTHEST = 80.0  # metres; farther pixels are ignored
# Metres between the bins of range in which the least confident pixels are dropped.
BINS = (0.0, 5.0, 10.0, 20.0, 40.0, 80.0)
DROPPED = 0.2


def measured_weights(truth: Tensor) -> Tensor:
    """Solid angle of the pixels in which errors are measured: surfaces that are not too far."""
    return pixel_weights(truth) * (truth <= _FARTHEST)


def fixed_batches(frames: Frames, size: int, model: NoiseModel) -> Iterator[Batch]:
    """All frames in order, each with points that are always the same."""
    for first in range(0, len(frames), size):
        chosen = range(first, min(first + size, len(frames)))
        points = [simulate(frames[i], np.random.RandomState([i, 1]), model) for i in chosen]
        yield collate([plain(frames[i], own) for i, own in zip(chosen, points)])


@torch.no_grad()
def validate(
    network: Network, frames: Frames, device: torch.device, bfloat16: bool = False
) -> dict[str, float]:
    """Mean errors over all frames; the scale of the input is taken as known."""
    model = NoiseModel() if network.knows_any_unit else replace(NoiseModel(), scale=(1.0, 1.0))
    sums: dict[str, float] = {}
    for batch in fixed_batches(frames, 4, model):
        batch = batch.to(device)
        tensors = network.tensors(batch.inputs, bfloat16)
        for name, value in _sums(network, tensors, batch).items():
            sums[name] = sums.get(name, 0.0) + value
    weight, count = max(sums.pop("weight"), 1e-9), sums.pop("count")
    means = {name: sums.pop(name) / weight for name in ("absrel", "delta1")}
    return {**means, **{name: value / count for name, value in sums.items()}}


def _sums(network: Network, tensors: Mapping[str, Tensor], batch: Batch) -> dict[str, float]:
    """`absrel` and `delta1` times the weight of their pixels, the others times the frames."""
    outputs = {port["name"]: tensors[port["tensor"]] for port in network.description.graph.outputs}
    weight = measured_weights(batch.truth)
    depth = predicted_depth(outputs) / batch.scale
    truth = torch.where(batch.truth > 0, batch.truth, 1.0)
    relative = (depth - truth).abs() / truth
    within = torch.maximum(depth / truth, truth / depth) < 1.25
    sums = {
        "absrel": (relative * weight).sum().item(),
        "delta1": (within * weight).sum().item(),
        "weight": weight.sum().item(),
        "count": len(truth),
    }
    if "log_metric_scale" in outputs:
        metric = (outputs["scale"] / batch.scale / batch.camera_height).log()
        sums["scale_error"] = (outputs["log_metric_scale"] - metric).abs().sum().item()
    if "ground" in outputs:
        said, true = outputs["ground"] > 0.5, batch.ground > 0.5
        union = (said | true).flatten(1).sum(dim=1).clamp(min=1)
        sums["ground_overlap"] = ((said & true).flatten(1).sum(dim=1) / union).sum().item()
        cuts = [error_cut(*each) for each in zip(relative, outputs["confidence"], truth, weight)]
        sums["error_cut"] = sum(cuts)
    return sums


def error_cut(relative: Tensor, confidence: Tensor, truth: Tensor, weight: Tensor) -> float:
    """The fraction by which the RMS of the relative error falls when the least confident fifth of
    the pixels is dropped; the mean over the bins of range."""
    cuts = []
    for low, high in zip(BINS, BINS[1:]):
        inside = (weight > 0) & (truth > low) & (truth <= high)
        if inside.sum() < 100:  # pixels; too few to drop a fifth of them
            continue
        squared, own, sure = relative[inside] ** 2, weight[inside], confidence[inside].float()
        order = sure.argsort(descending=True)
        kept = order[own[order].cumsum(0) <= (1 - DROPPED) * own.sum()]
        before = (squared * own).sum() / own.sum()
        after = (squared[kept] * own[kept]).sum() / own[kept].sum()
        cuts.append(1 - (after / before).sqrt().item())
    return float(np.mean(cuts)) if cuts else 0.0
