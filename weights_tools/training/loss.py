"""The losses of training. Errors are those of the logarithm of depth, weighted by solid angle. The
loss of the completed depth is the mean of that error and the relative error; where the network is
unsure between two surfaces the relative error prefers the nearer one."""

import math
from collections.abc import Mapping

import torch
import torch.nn.functional as F
from torch import Tensor

from weights_tools.network import Network
from weights_tools.training.batches import Batch
from weights_tools.training.normals import surface_normals
from weights_tools.training.sphere import row_weights

# Weights of the terms. Depth matters most; the other terms mainly train branches of their own. The
# metric scale is one number for an image; with 0.2, half of the encoder's gradient came from it.
WEIGHTS = {"depth": 1.0, "confidence": 0.1, "propagated": 0.2, "metric": 0.05, "ground": 0.1}
# The least depth in metres; smaller predictions are raised to it.
_LEAST = 1e-2
# Neighbours of a pixel whose range differs by more than this fraction are another surface.
_EDGE = 0.1
# The relative error that the confidence should state in the sky, which has no depth.
_SKY_ERROR = 1.0


def losses(
    network: Network, batch: Batch, bfloat16: bool = False, with_normals: bool = False
) -> dict[str, Tensor]:
    """The terms that the network has outputs for, by name, without their weights."""
    tensors = network.tensors(batch.inputs, bfloat16)
    ports = {port["name"]: tensors[port["tensor"]] for port in network.description.graph.outputs}
    weight = pixel_weights(batch.truth)
    # Depth in the unit of the input; 1 where there is none, which has no weight.
    truth = torch.where(batch.truth > 0, batch.truth * batch.scale, 1.0)
    if "log_depth" not in ports:
        # The depth may be negative; its relative error has a derivative everywhere.
        relative = (ports["depth"].float() - truth).abs() / truth
        return {"depth": _mean(relative, weight)}
    target = (truth / ports["scale"]).log()
    difference = ports["log_depth"] - target
    relative = relative_error(difference)
    terms = {"depth": _mean((difference.abs() + relative) / 2, weight)}
    if with_normals:
        terms["normals"] = _normals(difference, truth, weight)
    if "ground" not in ports:
        return terms
    everywhere = pixel_weights(torch.ones_like(batch.truth))
    known = torch.where(batch.truth > 0, relative.detach(), _SKY_ERROR)
    odds, ground_odds = tensors["log_odds"].float().split(1, dim=1)
    metric = (ports["scale"] / batch.scale / batch.camera_height).log()
    unlikely = F.binary_cross_entropy_with_logits(ground_odds, batch.ground, reduction="none")
    return {
        **terms,
        # Laplace's likelihood: least where exp(-odds) is the expected relative error.
        "confidence": _mean(known * odds.exp() - odds, everywhere),
        "propagated": _propagated(tensors["propagated"], target, weight),
        "metric": (ports["log_metric_scale"] - metric).abs().mean(),
        "ground": _mean(unlikely, everywhere),
    }


def _normals(difference: Tensor, truth: Tensor, weight: Tensor) -> Tensor:
    """The mean of 1 less the cosine between true and completed normals, away from edges."""
    near = [truth.roll(1, -1), truth.roll(-1, -1), truth.roll(1, -2), truth.roll(-1, -2)]
    is_edge = torch.stack([(truth - other).abs() > _EDGE * truth for other in near]).any(dim=0)
    smooth = (weight * ~is_edge)[..., 1:-1, :]
    true = surface_normals(truth)
    completed = surface_normals(truth * difference.clamp(-2, 2).exp())
    return _mean(1 - (true * completed).sum(dim=1, keepdim=True), smooth)


def _propagated(propagated: Tensor, target: Tensor, weight: Tensor) -> Tensor:
    """The mean error of an image that may be a fraction of the target's size; each of its pixels
    stands for a square of the target's."""
    step = target.shape[-1] // propagated.shape[-1]
    grown = propagated.repeat_interleave(step, -2).repeat_interleave(step, -1)
    return _mean((grown - target).abs(), weight)


def relative_error(difference: Tensor) -> Tensor:
    """|estimate / truth - 1| for a difference of logarithms. Beyond a factor of e it continues
    linearly, so that a few pixels do not outweigh an image."""
    inside = difference.clamp(max=1.0)
    return inside.expm1().abs() + math.e * (difference - inside)


def total(terms: Mapping[str, Tensor], normals: float = 0.0) -> Tensor:
    """The weighted sum; `normals` is the weight of their term, if there is one."""
    weights = {**WEIGHTS, "normals": normals}
    return sum((weights[name] * value for name, value in terms.items()), torch.zeros(()))


def pixel_weights(truth: Tensor) -> Tensor:
    """Solid angle where there is a surface."""
    rows = torch.from_numpy(row_weights(truth.shape[-2])).to(truth)
    return rows[:, None] * (truth > 0)


def predicted_depth(outputs: Mapping[str, Tensor]) -> Tensor:
    """The depth that the outputs state, in the unit of the input."""
    if "log_depth" in outputs:
        return outputs["scale"] * outputs["log_depth"].exp()
    return outputs["depth"].float().clamp(min=_LEAST)


def _mean(values: Tensor, weight: Tensor) -> Tensor:
    return (values * weight).sum() / weight.sum().clamp(min=1.0)
