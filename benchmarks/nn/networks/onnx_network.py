"""Writes a network as an ONNX model, so that ONNX Runtime can run what `nn` runs."""

import warnings
from collections.abc import Mapping
from pathlib import Path
from unittest import mock

import torch
import torch.nn.functional as F
from torch import Tensor

from weights_tools import operations
from weights_tools.graph import Graph, run

_OPSET = 13


def export(
    path: Path, graph: Graph, weights: Mapping[str, Tensor], inputs: Mapping[str, Tensor]
) -> None:
    """Writes the model for inputs of that size; its outputs are out0, out1, ... in the graph's order."""

    class Model(torch.nn.Module):
        def forward(self, *given: Tensor) -> tuple[Tensor, ...]:
            tensors = run(graph, weights, dict(zip(inputs, given)))
            return tuple(tensors[port["tensor"]] for port in graph.outputs)

    names = [f"out{i}" for i in range(len(graph.outputs))]
    plain = {**operations.OPERATIONS, "median_log": _median_log}
    with (
        mock.patch.object(operations, "pad", _pad),
        mock.patch.object(torch, "where", _where),
        mock.patch.dict(operations.OPERATIONS, plain),
        warnings.catch_warnings(),
        torch.no_grad(),
    ):
        warnings.simplefilter("ignore")  # of what cannot be folded into constants
        torch.onnx.export(
            Model(), tuple(inputs.values()), path, opset_version=_OPSET,
            input_names=list(inputs), output_names=names,
        )  # fmt: skip


_torch_where = torch.where


def _where(condition: Tensor, a: Tensor | float, b: Tensor | float) -> Tensor:
    """With numbers as floats; exported, they would have double precision."""
    like = a if isinstance(a, Tensor) else b
    a, b = (v if isinstance(v, Tensor) else torch.full_like(like, v) for v in (a, b))
    return _torch_where(condition, a, b)


def _pad(x: Tensor, width: int, padding: str) -> Tensor:
    """As weights_tools.padding, of operations that ONNX has."""
    if width == 0:
        return x
    if padding == "zero":
        return F.pad(x, (width, width, width, width))
    if padding != "wrap_replicate":
        raise ValueError(f"ONNX has no padding {padding}")
    wide = torch.cat([x[..., -width:], x, x[..., :width]], dim=3)
    return F.pad(wide, (0, 0, width, width), "replicate")


def _median_log(depth: Tensor, confidence: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """As in weights_tools.operations, for one image, with a sorted list in place of a choice."""
    point = (depth > 0) & (confidence > 0)
    ranges = torch.where(point, depth, torch.full_like(depth, 1e30)).flatten().sort()[0]
    median = ranges[((point.sum() - 1) // 2).clamp(min=0)].reshape(1, 1, 1, 1)
    x = torch.where(point, depth / median, torch.ones_like(depth)).log()
    return x, torch.where(point, confidence.clamp(max=1), torch.zeros_like(depth)), median
