"""Padding of images (docs/formats/network.md)."""

from typing import Any

import torch
import torch.nn.functional as F
from torch import Tensor


def pad(x: Tensor, width: int, padding: str) -> Tensor:
    """Adds `width` pixels on each side of x, N x C x H x W."""
    if width == 0:
        return x
    if padding == "zero":
        return F.pad(x, (width, width, width, width))
    if padding == "wrap_replicate":
        if width <= x.shape[-1]:
            return _WrapReplicate.apply(x, width)
        return _wrap_columns(F.pad(x, (0, 0, width, width), mode="replicate"), width)
    if padding == "wrap_cross_pole":
        return _wrap_columns(_cross_poles(x, width), width)
    raise ValueError(f'padding "{padding}" is none of zero, wrap_replicate, wrap_cross_pole')


class _WrapReplicate(torch.autograd.Function):
    """The same in one pass, and in any data type: training spends much of its time here."""

    @staticmethod
    def forward(ctx: Any, x: Tensor, width: int) -> Tensor:
        ctx.width = width
        n, channels, height, columns = x.shape
        size = (n, height + 2 * width, columns + 2 * width, channels)
        if x.is_contiguous():
            y = x.new_empty((n, channels, *size[1:3]))
        else:
            y = x.new_empty(size).permute(0, 3, 1, 2)
        rows = y[:, :, width:-width]
        rows[..., width:-width] = x
        rows[..., :width] = x[..., columns - width :]
        rows[..., -width:] = x[..., :width]
        y[:, :, :width] = rows[:, :, :1]
        y[:, :, -width:] = rows[:, :, -1:]
        return y

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple[Tensor, None]:
        width = ctx.width

        def unwrap(rows: Tensor) -> Tensor:
            inner = rows[..., width:-width].clone(memory_format=torch.preserve_format)
            inner[..., :width] += rows[..., -width:]
            inner[..., -width:] += rows[..., :width]
            return inner

        result = unwrap(gradient[:, :, width:-width])
        result[:, :, :1] += unwrap(gradient[:, :, :width].sum(dim=2, keepdim=True))
        result[:, :, -1:] += unwrap(gradient[:, :, -width:].sum(dim=2, keepdim=True))
        return result, None


def _wrap_columns(x: Tensor, width: int) -> Tensor:
    """Longitude continues at the other side; an image narrower than `width` is repeated."""
    while width > 0:
        step = min(width, x.shape[-1])
        x = torch.cat([x[..., -step:], x, x[..., :step]], dim=-1)
        width -= step
    return x


def _cross_poles(x: Tensor, width: int) -> Tensor:
    """Beyond a pole the image continues along the opposite meridian, half a turn away."""
    if x.shape[-1] % 2 != 0:
        raise ValueError(f"wrap_cross_pole needs an even width, not {x.shape[-1]}")
    while width > 0:
        step = min(width, x.shape[-2])
        opposite = torch.roll(x, x.shape[-1] // 2, dims=-1).flip(-2)
        x = torch.cat([opposite[..., -step:, :], x, opposite[..., :step, :]], dim=-2)
        width -= step
    return x
