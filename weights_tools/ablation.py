"""Networks in which some tensors count nothing, to measure what these parts gain."""

from collections.abc import Sequence
from dataclasses import replace

from weights_tools.builder import Description
from weights_tools.graph import Graph, Node


def without(description: Description, tensors: Sequence[str]) -> Description:
    """The same network without what graph_without takes out of it."""
    return replace(description, graph=graph_without(description.graph, tensors))


def graph_without(graph: Graph, tensors: Sequence[str]) -> Graph:
    """The same graph, but nodes that read one of these tensors read zeros of its shape. Layers stay,
    those that only led there without an influence. An unknown name is a ValueError."""
    inputs = {port["name"] for port in graph.inputs}
    known = inputs.union(*(node.outputs for node in graph.nodes))
    for name in tensors:
        if name not in known:
            raise ValueError(f'"{graph.name}" has no tensor "{name}"')
    zero = {name: f"{name}.zero" for name in tensors}

    def zeros(name: str) -> Node:
        return Node(zero[name], "affine", [name], [zero[name]], {}, {"scale": 0.0, "offset": 0.0})

    nodes = [zeros(port["name"]) for port in graph.inputs if port["name"] in zero]
    for node in graph.nodes:
        nodes.append(replace(node, inputs=[zero.get(name, name) for name in node.inputs]))
        nodes += [zeros(name) for name in node.outputs if name in zero]
    return replace(graph, nodes=nodes)
