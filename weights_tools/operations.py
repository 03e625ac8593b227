"""Every operation of docs/formats/network.md in PyTorch, by the name it has in a network file.

Tensors are N x C x H x W: training has batches, the C++ library has not. Tensors come first, then
weights and attributes by the names they have in the file. Values are those of the document in every
data type; where a derivative does not exist (no confidence at all), it is zero, so that training
never meets NaN there.
"""

import math
from collections.abc import Callable

import torch
import torch.nn.functional as F
from torch import Tensor

from weights_tools.padding import pad

# Keeps N / D defined where there is no confidence; far below any confidence that matters.
EPSILON = 1e-20


def normalized_convolution(
    x: Tensor, c: Tensor, *, weight: Tensor, bias: Tensor, padding: str
) -> tuple[Tensor, Tensor]:
    """Mean of the known values, and how much of the weights was known. Weights are >= 0."""
    both = pad(torch.cat([x * c, c]), weight.shape[-1] // 2, padding)
    numerator, denominator = F.conv2d(both, weight).chunk(2)
    # The numerator is zero where the denominator is: any divisor gives the value, this one also
    # gives a derivative that does not overflow.
    divisor = torch.where(denominator == 0, 1.0, denominator + EPSILON)
    y = numerator / divisor + bias[:, None, None]
    return y, denominator / weight.sum(dim=(1, 2, 3))[:, None, None]


def confidence_pool(x: Tensor, c: Tensor, *, rule: str) -> tuple[Tensor, Tensor]:
    """The most confident of each 2 x 2 square, the first in row-major order among equals."""
    largest, index = F.max_pool2d(c, 2, return_indices=True)
    value = x.flatten(2).gather(2, index.flatten(2)).view_as(largest)
    if rule == "quarter":
        return value, largest / 4
    if rule == "sqrt":
        none = largest == 0
        return value, torch.where(none, 0.0, torch.where(none, 1.0, largest).sqrt())
    raise ValueError(f'rule "{rule}" is neither quarter nor sqrt')


def convolution(x: Tensor, *, weight: Tensor, bias: Tensor, stride: int, padding: str) -> Tensor:
    return F.conv2d(pad(x, weight.shape[-1] // 2, padding), weight, bias, stride)


def dense(x: Tensor, *, weight: Tensor, bias: Tensor) -> Tensor:
    return F.linear(x.flatten(1), weight, bias)[:, :, None, None]


def upsample_nearest(x: Tensor) -> Tensor:
    return F.interpolate(x, scale_factor=2, mode="nearest")


def upsample_bilinear(x: Tensor, *, padding: str) -> Tensor:
    if x.dtype == torch.bfloat16 and padding != "wrap_cross_pole":
        return _upsample_bilinear_short(x, padding)
    twice = F.interpolate(pad(x, 1, padding), scale_factor=2, mode="bilinear", align_corners=False)
    return twice[..., 2:-2, 2:-2]


def _upsample_bilinear_short(x: Tensor, padding: str) -> Tensor:
    """For training in bfloat16: as products with matrices it is many times faster than PyTorch's
    own, and nothing needs to be padded. (NaN would spread over whole rows and columns.)"""
    n, channels, height, width = x.shape
    rows = _halfway(height, "replicate" if padding == "wrap_replicate" else "zero", x)
    columns = _halfway(width, "wrap" if padding == "wrap_replicate" else "zero", x)
    x = x.permute(0, 2, 3, 1).reshape(n, height, width * channels)
    x = (rows @ x).view(n * 2 * height, width, channels)
    return (columns @ x).view(n, 2 * height, 2 * width, channels).permute(0, 3, 1, 2)


def _halfway(size: int, edge: str, like: Tensor) -> Tensor:
    """2 size x size: three quarters of the nearest sample and a quarter of the next."""
    matrix = like.new_zeros(2 * size, size)
    i = torch.arange(size, device=like.device)
    for first, step in ((0, -1), (1, 1)):
        matrix[2 * i + first, i] += 0.75
        beside = i + step
        inside = (beside >= 0) & (beside < size)
        if edge == "wrap":
            inside, beside = torch.ones_like(inside), beside % size
        elif edge == "replicate":
            inside, beside = torch.ones_like(inside), beside.clamp(0, size - 1)
        matrix[2 * i[inside] + first, beside[inside]] += 0.25
    return matrix


def convex_upsample(x: Tensor, weights: Tensor, *, padding: str, factor: int = 2) -> Tensor:
    n, _, height, width = x.shape
    neighbours = F.unfold(pad(x, 1, padding), 3).view(n, 1, 9, height, width)
    fractions = weights.view(n, factor * factor, 9, height, width).softmax(dim=2)
    return F.pixel_shuffle((fractions * neighbours).sum(dim=2), factor)


def average_pool(x: Tensor) -> Tensor:
    return F.avg_pool2d(x, 2)


def global_average_pool(x: Tensor) -> Tensor:
    return x.mean(dim=(2, 3), keepdim=True)


def softplus(x: Tensor) -> Tensor:
    # F.softplus turns into the identity above 20, which double precision would see.
    return -F.logsigmoid(-x)


def leaky_relu(x: Tensor, *, slope: float) -> Tensor:
    return F.leaky_relu(x, slope)


def clamp(x: Tensor, *, minimum: float, maximum: float) -> Tensor:
    return x.clamp(minimum, maximum)


def affine(x: Tensor, *, scale: float, offset: float) -> Tensor:
    return scale * x + offset


def concatenate(*parts: Tensor) -> Tensor:
    return torch.cat(parts, dim=1)


def slice_channels(x: Tensor, *, first: int, count: int) -> Tensor:
    return x[:, first : first + count]


def median_log(depth: Tensor, confidence: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Sparse depth relative to its median, in logarithms; each image of a batch has its own."""
    point = depth.isfinite() & (depth > 0) & (confidence > 0)
    medians = [d[p].median() if p.any() else d.new_ones(()) for d, p in zip(depth, point)]
    median = torch.stack(medians)[:, None, None, None]
    x = torch.where(point, torch.where(point, depth / median, 1.0).log(), 0.0)
    return x, torch.where(point, confidence.clamp(max=1), 0.0), median


def latitude_sine(x: Tensor) -> Tensor:
    height = x.shape[-2]
    row = torch.arange(height, dtype=x.dtype, device=x.device)
    sine = torch.sin(math.pi / 2 - math.pi * (row + 0.5) / height)
    return sine[None, None, :, None].expand(x.shape[0], 1, height, x.shape[-1])


OPERATIONS: dict[str, Callable[..., Tensor | tuple[Tensor, ...]]] = {
    "normalized_convolution": normalized_convolution,
    "confidence_pool": confidence_pool,
    "convolution": convolution,
    "dense": dense,
    "upsample_nearest": upsample_nearest,
    "upsample_bilinear": upsample_bilinear,
    "convex_upsample": convex_upsample,
    "average_pool": average_pool,
    "global_average_pool": global_average_pool,
    "relu": torch.relu,
    "tanh": torch.tanh,
    "sigmoid": torch.sigmoid,
    "softplus": softplus,
    "exp": torch.exp,
    "log": torch.log,
    "leaky_relu": leaky_relu,
    "clamp": clamp,
    "affine": affine,
    "add": torch.add,
    "multiply": torch.mul,
    "concatenate": concatenate,
    "slice": slice_channels,
    "median_log": median_log,
    "latitude_sine": latitude_sine,
}
