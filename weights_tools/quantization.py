"""Convolutions of 8-bit integers, as `nn` computes them (docs/formats/network.md), and the ranges of
their inputs that a calibration finds.

The input of a convolution is rounded to a byte by one scale, the weights to a signed byte by a scale
of each output channel. Sums are exact.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from weights_tools.graph import Graph, Node, run
from weights_tools.padding import pad

LARGEST_BYTE = 255
LARGEST_WEIGHT = 127
# Inputs of fewer channels are images and positions, which need more digits; `nn` keeps them floats.
MIN_CHANNELS = 13

Ranges = Mapping[str, tuple[float, float]]  # of the input of a convolution, by its name


def byte_scale(minimum: float, maximum: float) -> tuple[np.float32, int]:
    """Steps per unit, and the byte that means zero."""
    low, high = min(np.float32(minimum), np.float32(0)), max(np.float32(maximum), np.float32(0))
    steps = np.float32(LARGEST_BYTE) / (high - low) if high > low else np.float32(1)
    return steps, int(np.rint(-low * steps))


def round_input(x: Tensor, minimum: float, maximum: float) -> Tensor:
    """Bytes, 0 to 255, less the one that means zero."""
    steps, zero = byte_scale(minimum, maximum)
    # In single precision, as `nn` multiplies: what is halfway between two bytes depends on it. NaN
    # becomes the largest byte.
    wanted = (x.float() * float(steps)).nan_to_num(nan=LARGEST_BYTE, posinf=None, neginf=None)
    return wanted.round().clamp(-zero, LARGEST_BYTE - zero).to(x.dtype)


def round_weights(weight: Tensor) -> tuple[Tensor, Tensor]:
    """Signed bytes, and what one of them is worth in each output channel. Each weight of a filter of
    one input channel absorbs the remainder of the one before, which keeps their sum."""
    filters = weight.float().flatten(2)
    step = filters.abs().amax(dim=(1, 2)) / LARGEST_WEIGHT
    step = torch.where(step > 0, step, torch.ones_like(step))
    rounded, left = torch.empty_like(filters), torch.zeros_like(filters[:, :, 0])
    for tap in range(filters.shape[2]):
        wanted = filters[:, :, tap] / step[:, None] + left
        rounded[:, :, tap] = wanted.round().clamp(-LARGEST_WEIGHT, LARGEST_WEIGHT)
        left = wanted - rounded[:, :, tap]
    return rounded.view_as(weight), step


def convolution_of_bytes(
    x: Tensor, *, weight: Tensor, bias: Tensor, stride: int, padding: str,
    range_of_input: tuple[float, float],
) -> Tensor:  # fmt: skip
    """`convolution` with its input and weights rounded to bytes. Sums are formed in double precision,
    which holds them exactly."""
    rounded, step = round_weights(weight)
    bytes_ = round_input(x, *range_of_input)
    sums = F.conv2d(pad(bytes_.double(), weight.shape[-1] // 2, padding), rounded.double(), None, stride)
    scale = step / float(byte_scale(*range_of_input)[0])
    return (sums.to(x.dtype) * scale.to(x.dtype)[:, None, None]) + bias[:, None, None]


def rounded_convolutions(graph: Graph, ranges: Ranges) -> dict[str, Callable[..., Tensor]]:
    """What takes the place of the convolutions that have a range (`run`)."""
    return {
        node.name: partial(convolution_of_bytes, range_of_input=ranges[node.name])
        for node in convolutions(graph)
        if node.name in ranges
    }


def convolutions(graph: Graph) -> list[Node]:
    return [node for node in graph.nodes if node.op == "convolution"]


def calibrate(
    graph: Graph,
    weights: Mapping[str, Tensor],
    samples: Iterable[Mapping[str, Tensor]],
    excluded: Sequence[str] = (),
    values: int = 20000,
) -> dict[str, tuple[float, float]]:
    """The range of the input of each convolution for which rounding to bytes has the least mean
    square error over the samples' values, of which `values` of each are drawn."""
    random = np.random.RandomState(0)
    drawn: dict[str, list[np.ndarray]] = {}
    nodes = [
        node
        for node in convolutions(graph)
        if node.name not in excluded
        and weights[node.weights["weight"]].shape[1] >= MIN_CHANNELS
    ]
    for inputs in samples:
        tensors = run(graph, weights, inputs)
        for node in nodes:
            x = tensors[node.inputs[0]].flatten()
            chosen = torch.from_numpy(random.randint(0, len(x), values))
            ends = torch.stack([x.min(), x.max()])
            drawn.setdefault(node.name, []).append(torch.cat([ends, x[chosen]]).numpy())
    ranges = {name: best_range(np.concatenate(own)) for name, own in drawn.items()}
    return {name: ends for name, ends in ranges.items() if ends[1] > 0}  # `nn` takes no others


def best_range(values: np.ndarray) -> tuple[float, float]:
    """The ends of the range that has the least mean square error when values are rounded to bytes."""
    x = torch.from_numpy(values)
    low, high = min(float(x.min()), 0.0), max(float(x.max()), 0.0)
    fractions = np.linspace(0.1, 1, 19)

    def error(ends: tuple[float, float]) -> float:
        if ends[0] == ends[1]:
            return float((x * x).mean())
        steps = byte_scale(*ends)[0]
        return float(((round_input(x, *ends) / float(steps) - x) ** 2).mean())

    ends = [(low * a, high * b) for a in (fractions if low < 0 else [1]) for b in fractions]
    return min(ends, key=error)
