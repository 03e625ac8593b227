"""A network as the file of docs/formats/network.md describes it, and PyTorch running it."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from types import MappingProxyType
from typing import Any

import torch
from torch import Tensor

from weights_tools.operations import OPERATIONS


@dataclass(frozen=True)
class Node:
    name: str
    op: str
    inputs: list[str]
    outputs: list[str]
    weights: dict[str, str] = field(default_factory=dict)  # role (weight, bias) to name
    attributes: dict[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Graph:
    name: str
    size_multiple: int
    inputs: list[dict[str, Any]]  # name, channels
    nodes: list[Node]
    outputs: list[dict[str, str]]  # name, tensor
    normalisation: dict[str, Any]
    provenance: dict[str, Any] = field(default_factory=dict)

    def to_json(self) -> str:
        return json.dumps(asdict(self), ensure_ascii=False, separators=(",", ":"))

    @staticmethod
    def from_json(text: str) -> "Graph":
        fields = json.loads(text)
        return Graph(**{**fields, "nodes": [Node(**node) for node in fields["nodes"]]})


# Operations whose results need no more digits than bfloat16 has, where it saves time.
_SHORT = ("convolution", "relu", "leaky_relu", "add", "upsample_nearest", "upsample_bilinear")


def run(
    graph: Graph,
    weights: Mapping[str, Tensor],
    inputs: Mapping[str, Tensor],
    bfloat16: bool = False,
    behind: Mapping[str, Callable[[Tensor], Tensor]] = MappingProxyType({}),
    instead: Mapping[str, Callable[..., Any]] = MappingProxyType({}),
) -> dict[str, Tensor]:
    """Every tensor of the network by name: the inputs and what each node wrote. With `bfloat16`
    convolutions multiply in that type, and what follows keeps it until more is needed. `behind`:
    what is done to the result of a convolution, by the name of its layer. `instead`: what is computed
    in the place of a node's operation, by the name of the node."""
    tensors = {port["name"]: inputs[port["name"]] for port in graph.inputs}
    slices: dict[str, Tensor] = {}
    for node in graph.nodes:
        given = [tensors[name] for name in node.inputs]
        own = {role: weights[name] for role, name in node.weights.items()}
        if node.op == "convolution":
            # The format with channels last is faster, in bfloat16 several times.
            given = [values.contiguous(memory_format=torch.channels_last) for values in given]
            if bfloat16:
                given = [values.bfloat16() for values in given]
                own = {role: values.bfloat16() for role, values in own.items()}
        elif bfloat16 and node.op not in _SHORT:
            given = [values.float() for values in given]
        if node.op == "slice":
            if node.outputs[0] not in slices:
                slices |= _slices(graph, node.inputs[0], given[0])
            results = slices[node.outputs[0]]
        else:
            operation = instead.get(node.name, OPERATIONS[node.op])
            results = operation(*given, **own, **node.attributes)
        layer = node.weights.get("weight", "").removesuffix(".weight")
        if layer in behind:
            results = behind[layer](results)
        results = (results,) if isinstance(results, Tensor) else results
        tensors.update(zip(node.outputs, results, strict=True))
    return tensors


def _slices(graph: Graph, name: str, x: Tensor) -> dict[str, Tensor]:
    """All slices of a tensor, by their names, from one split of it: its derivative is put together
    once, where that of each slice alone would be as large as the tensor."""
    nodes = [node for node in graph.nodes if node.op == "slice" and node.inputs == [name]]
    ranges = [(node.attributes["first"], node.attributes["count"]) for node in nodes]
    edges = sorted({0, x.shape[1]}.union(*((first, first + count) for first, count in ranges)))
    parts = x.split([end - start for start, end in zip(edges, edges[1:])], dim=1)
    results = {}
    for node, (first, count) in zip(nodes, ranges):
        inside = parts[edges.index(first) : edges.index(first + count)]
        results[node.outputs[0]] = inside[0] if len(inside) == 1 else torch.cat(inside, dim=1)
    return results
