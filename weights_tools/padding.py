"""What stands around a picture when an operation reaches over its edge (docs/networks.md)."""

import torch
import torch.nn.functional as F
from torch import Tensor


def pad(x: Tensor, width: int, padding: str) -> Tensor:
    """Adds `width` pixels on each side of x, N x C x H x W."""
    if padding == "zero":
        return F.pad(x, (width, width, width, width))
    if padding == "wrap_replicate":
        return _wrap_columns(F.pad(x, (0, 0, width, width), mode="replicate"), width)
    if padding == "wrap_cross_pole":
        return _wrap_columns(_cross_poles(x, width), width)
    raise ValueError(f'padding "{padding}" is none of zero, wrap_replicate, wrap_cross_pole')


def _wrap_columns(x: Tensor, width: int) -> Tensor:
    """Longitude goes on at the other side. A picture narrower than `width` goes round again."""
    while width > 0:
        step = min(width, x.shape[-1])
        x = torch.cat([x[..., -step:], x, x[..., :step]], dim=-1)
        width -= step
    return x


def _cross_poles(x: Tensor, width: int) -> Tensor:
    """Beyond a pole the picture goes on down the opposite meridian, half a turn away."""
    if x.shape[-1] % 2 != 0:
        raise ValueError(f"wrap_cross_pole needs an even width, not {x.shape[-1]}")
    while width > 0:
        step = min(width, x.shape[-2])
        opposite = torch.roll(x, x.shape[-1] // 2, dims=-1).flip(-2)
        x = torch.cat([opposite[..., -step:, :], x, opposite[..., :step, :]], dim=-2)
        width -= step
    return x
