"""A network as the file of docs/networks.md describes it, and PyTorch running it."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

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


def run(
    graph: Graph, weights: Mapping[str, Tensor], inputs: Mapping[str, Tensor]
) -> dict[str, Tensor]:
    """Every tensor of the network by name: the inputs and what each node wrote."""
    tensors = {port["name"]: inputs[port["name"]] for port in graph.inputs}
    for node in graph.nodes:
        results = OPERATIONS[node.op](
            *(tensors[name] for name in node.inputs),
            **{role: weights[name] for role, name in node.weights.items()},
            **node.attributes,
        )
        results = (results,) if isinstance(results, Tensor) else results
        tensors.update(zip(node.outputs, results, strict=True))
    return tensors
