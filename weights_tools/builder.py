"""Describes a network node by node; PyTorch runs this description, and files contain it."""

from dataclasses import dataclass, field
from typing import Any, NamedTuple

from weights_tools.graph import Graph, Node


@dataclass(frozen=True)
class Symbol:
    """A tensor of the network, for images of any size."""

    name: str
    channels: int
    level: int | None = 0  # number of times the image's size is halved; None: one pixel


class Pair(NamedTuple):
    """A value and its confidence, of equal shape."""

    x: Symbol
    c: Symbol


@dataclass(frozen=True)
class Layer:
    """Weights NAME.weight and NAME.bias; nodes may share them."""

    name: str
    shape: tuple[int, ...]  # outputs x inputs, for convolutions x size x size
    is_normalized: bool = False  # of a normalized convolution: never negative
    slope: float = 1.0  # of the activation that follows, for x < 0; 1 if there is none
    gain: float = 1.0  # factor on the initial weights
    prior: tuple[float, ...] = ()  # added to the initial bias

    @property
    def outputs(self) -> int:
        return self.shape[0]

    @property
    def parameters(self) -> int:
        return self.weights + self.outputs

    @property
    def weights(self) -> int:
        count = 1
        for size in self.shape:
            count *= size
        return count


class Cost(NamedTuple):
    """Multiply-accumulates of one node for each pixel of its output."""

    node: str
    per_pixel: int
    level: int | None


@dataclass
class Builder:
    """Builds a description. `padding` applies to every node that reaches over an edge."""

    name: str
    size_multiple: int
    padding: str
    inputs: list[Symbol] = field(default_factory=list)
    nodes: list[Node] = field(default_factory=list)
    layers: dict[str, Layer] = field(default_factory=dict)
    costs: list[Cost] = field(default_factory=list)

    def input(self, name: str, channels: int) -> Symbol:
        self.inputs.append(Symbol(name, channels))
        return self.inputs[-1]

    def layer(self, layer: Layer) -> Layer:
        if layer.name in self.layers:
            raise ValueError(f'there are two layers named "{layer.name}"')
        self.layers[layer.name] = layer
        return layer

    def node(
        self,
        op: str,
        inputs: list[Symbol],
        outputs: list[Symbol],
        layer: Layer | None = None,
        **attributes: Any,
    ) -> None:
        """Appends a node; it is named as its first output."""
        weights = {}
        if layer:
            weights = {role: f"{layer.name}.{role}" for role in ("weight", "bias")}
            sums = 2 if layer.is_normalized else 1
            self.costs.append(Cost(outputs[0].name, sums * layer.weights, outputs[0].level))
        names = [symbol.name for symbol in outputs]
        reads = [symbol.name for symbol in inputs]
        self.nodes.append(Node(names[0], op, reads, names, weights, attributes))

    # Operations with weights.

    def normalized_layer(self, name: str, inputs: int, outputs: int, size: int) -> Layer:
        return self.layer(Layer(name, (outputs, inputs, size, size), is_normalized=True))

    def normalized_convolution(self, name: str, pair: Pair, layer: Layer) -> Pair:
        result = _pair(name, layer.outputs, pair.x.level)
        self.node("normalized_convolution", list(pair), list(result), layer, padding=self.padding)
        return result

    def convolution(
        self,
        name: str,
        x: Symbol,
        outputs: int,
        size: int = 3,
        stride: int = 1,
        slope: float = 1.0,
        gain: float = 1.0,
        prior: tuple[float, ...] = (),
    ) -> Symbol:
        """A convolution and its activation: none for slope 1, ReLU for 0, else leaky ReLU."""
        shape = (outputs, x.channels, size, size)
        layer = self.layer(Layer(name, shape, False, slope, gain, prior))
        assert x.level is not None
        linear = Symbol(_before_activation(name, slope), outputs, x.level + stride // 2)
        self.node("convolution", [x], [linear], layer, stride=stride, padding=self.padding)
        return self.activation(name, linear, slope)

    def dense(
        self, name: str, x: Symbol, outputs: int, slope: float = 1.0, gain: float = 1.0
    ) -> Symbol:
        layer = self.layer(Layer(name, (outputs, x.channels), False, slope, gain))
        linear = Symbol(_before_activation(name, slope), outputs, None)
        self.node("dense", [x], [linear], layer)
        return self.activation(name, linear, slope)

    # Operations without weights.

    def activation(self, name: str, x: Symbol, slope: float) -> Symbol:
        if slope == 1:
            return x
        if slope == 0:
            return self.pointwise("relu", name, x)
        return self.pointwise("leaky_relu", name, x, slope=slope)

    def pointwise(self, op: str, name: str, *inputs: Symbol, **attributes: float) -> Symbol:
        """An element-wise operation on one tensor or on two of equal shape."""
        result = Symbol(name, inputs[0].channels, inputs[0].level)
        self.node(op, list(inputs), [result], **attributes)
        return result

    def concatenate(self, name: str, *parts: Symbol) -> Symbol:
        result = Symbol(name, sum(part.channels for part in parts), parts[0].level)
        self.node("concatenate", list(parts), [result])
        return result

    def concatenate_pairs(self, name: str, *pairs: Pair) -> Pair:
        return Pair(
            self.concatenate(name, *(pair.x for pair in pairs)),
            self.concatenate(f"{name}.c", *(pair.c for pair in pairs)),
        )

    def slice(self, name: str, x: Symbol, first: int, count: int) -> Symbol:
        result = Symbol(name, count, x.level)
        self.node("slice", [x], [result], first=first, count=count)
        return result

    def confidence_pool(self, name: str, pair: Pair, rule: str) -> Pair:
        assert pair.x.level is not None
        result = _pair(name, pair.x.channels, pair.x.level + 1)
        self.node("confidence_pool", list(pair), list(result), rule=rule)
        return result

    def average_pool(self, name: str, x: Symbol) -> Symbol:
        assert x.level is not None
        result = Symbol(name, x.channels, x.level + 1)
        self.node("average_pool", [x], [result])
        return result

    def global_average_pool(self, name: str, x: Symbol) -> Symbol:
        result = Symbol(name, x.channels, None)
        self.node("global_average_pool", [x], [result])
        return result

    def upsample_nearest(self, name: str, x: Symbol) -> Symbol:
        result = _twice(name, x)
        self.node("upsample_nearest", [x], [result])
        return result

    def upsample_nearest_pair(self, name: str, pair: Pair) -> Pair:
        return Pair(
            self.upsample_nearest(name, pair.x), self.upsample_nearest(f"{name}.c", pair.c)
        )

    def upsample_bilinear(self, name: str, x: Symbol) -> Symbol:
        result = _twice(name, x)
        self.node("upsample_bilinear", [x], [result], padding=self.padding)
        return result

    def convex_upsample(self, name: str, x: Symbol, weights: Symbol) -> Symbol:
        result = _twice(name, x)
        self.node("convex_upsample", [x, weights], [result], padding=self.padding)
        return result

    def convex_filter(self, name: str, x: Symbol, weights: Symbol) -> Symbol:
        """A convex combination of the neighbours of each pixel, by a softmax of nine weights."""
        result = Symbol(name, x.channels, x.level)
        self.node("convex_upsample", [x, weights], [result], padding=self.padding, factor=1)
        return result

    def median_log(self, name: str, depth: Symbol, confidence: Symbol) -> tuple[Pair, Symbol]:
        """Logarithm of sparse depth over its median, its confidence; and the median."""
        pair, median = _pair(name, 1, depth.level), Symbol(f"{name}.median", 1, None)
        self.node("median_log", [depth, confidence], [*pair, median])
        return pair, median

    def latitude_sine(self, name: str, x: Symbol) -> Symbol:
        result = Symbol(name, 1, x.level)
        self.node("latitude_sine", [x], [result])
        return result

    def build(self, outputs: dict[str, Symbol], normalisation: dict[str, Any]) -> "Description":
        graph = Graph(
            name=self.name,
            size_multiple=self.size_multiple,
            inputs=[{"name": symbol.name, "channels": symbol.channels} for symbol in self.inputs],
            nodes=list(self.nodes),
            outputs=[{"name": name, "tensor": symbol.name} for name, symbol in outputs.items()],
            normalisation=dict(normalisation),
        )
        return Description(graph, list(self.layers.values()), list(self.costs))


@dataclass(frozen=True)
class Description:
    graph: Graph
    layers: list[Layer]
    costs: list[Cost]

    @property
    def parameters(self) -> int:
        return sum(layer.parameters for layer in self.layers)

    def multiply_accumulates(self, height: int, width: int) -> dict[str, int]:
        """Multiply-accumulates of each node with weights, for an image of that size."""
        return {
            cost.node: cost.per_pixel
            * (1 if cost.level is None else (height >> cost.level) * (width >> cost.level))
            for cost in self.costs
        }


def _pair(name: str, channels: int, level: int | None) -> Pair:
    return Pair(Symbol(name, channels, level), Symbol(f"{name}.c", channels, level))


def _twice(name: str, x: Symbol) -> Symbol:
    assert x.level is not None
    return Symbol(name, x.channels, x.level - 1)


def _before_activation(name: str, slope: float) -> str:
    return name if slope == 1 else f"{name}.linear"
