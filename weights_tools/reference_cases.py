"""Graphs with weights and inputs, for which the tests of `nn` compare with PyTorch."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from weights_tools import network_file, networks
from weights_tools.builder import Builder, Description, Layer, Pair, Symbol
from weights_tools.graph import Graph
from weights_tools.network import initial_weights

Arrays = dict[str, np.ndarray]  # channels x height x width


@dataclass(frozen=True)
class Reference:
    name: str
    graph: Graph
    weights: Arrays
    cases: dict[str, Arrays]  # inputs
    dtype: type[np.floating] = np.float32  # that the weights are stored in
    # Of the inputs of convolutions, which then are computed in 8-bit integers.
    ranges: dict[str, tuple[float, float]] = field(default_factory=dict)


def references() -> list[Reference]:
    """All networks in tests/nn/data."""
    return [
        _operation("convolution", _convolution, FLAT, np.float16),
        _operation("convolution_across_poles", _convolution, ACROSS, np.float16),
        _of_bytes(_operation("convolution_of_bytes", _deep_convolution, FLAT, np.float16)),
        _operation("normalized_convolution", _normalized_convolution, FLAT),
        _operation("normalized_convolution_across_poles", _normalized_convolution, ACROSS),
        _operation("pooling", _pooling, EVEN),
        _operation("upsampling", _upsampling, FLAT),
        _operation("upsampling_across_poles", _upsampling, ACROSS),
        _operation("elementwise", _elementwise, ANY),
        _operation("panorama", _panorama, ANY),
        network("unguided", networks.unguided(), (32, 64)),
        network("encoder_decoder", networks.encoder_decoder(12, (10, 10, 6, 6)), (32, 64)),
        network("multi_stream", networks.multi_stream(4, 10, 6), (16, 24)),
        network("depth_completion", networks.depth_completion(_NARROW, 10, 12), (128, 256)),
    ]


def full_networks() -> list[Reference]:
    """The networks with all their channels, which are too large to be stored."""
    return [
        network("encoder_decoder", networks.encoder_decoder(), (64, 128)),
        network("multi_stream", networks.multi_stream(), (64, 128)),
        network("depth_completion", networks.depth_completion(), (128, 256)),
        network(
            "depth_completion_across_poles",
            networks.depth_completion(padding="wrap_cross_pole"),
            (256, 512),
        ),
    ]


_NARROW = (6, 9, 12, 17, 20)  # channels that fill no block of 16


def network(name: str, description: Description, size: tuple[int, int]) -> Reference:
    """A network on a panorama with 5 % of its depths, and on one without any."""
    inputs = _panorama_inputs(description.graph, size, 0.05, len(name))
    none = {**inputs, "depth": 0 * inputs["depth"], "confidence": 0 * inputs["confidence"]}
    label = f"{size[0]}x{size[1]}"
    return Reference(
        name,
        description.graph,
        initial_weights(description, seed=1),
        {label: inputs, f"{label}_no_points": none},
        np.float16,
    )


def stored(path: Path) -> Reference:
    """A network file on a panorama with as many depths as SLAM has."""
    graph, weights = network_file.read(path)
    size = (256, 512)
    # Pooling by confidence takes the one or the other of two that differ by rounding only, which changes
    # the result by more than rounding. With this seed no two are so alike.
    inputs = _panorama_inputs(graph, size, 0.006, seed=1)
    dtype = next(iter(weights.values())).dtype.type
    return Reference(path.stem, graph, weights, {f"{size[0]}x{size[1]}": inputs}, dtype)


def _panorama_inputs(graph: Graph, size: tuple[int, int], fraction: float, seed: int) -> Arrays:
    random = np.random.RandomState(seed)
    known = random.uniform(size=(1, *size)) < fraction
    inputs = {
        # Whole numbers, as in images, compress well.
        "image": random.randint(0, 256, (3, *size)) / 255,
        "depth": known * random.randint(256, 80 * 256, known.shape) / 256,
        "confidence": known * random.randint(1, 256, known.shape) / 255,
    }
    return {port["name"]: inputs[port["name"]] for port in graph.inputs}


@dataclass(frozen=True)
class Sizes:
    multiple: int
    paddings: tuple[str, ...]
    sizes: tuple[tuple[int, int], ...]


_FLAT_PADDINGS = ("zero", "wrap_replicate")
# One pixel, less than a kernel reaches, odd sizes, more than a vector.
FLAT = Sizes(1, _FLAT_PADDINGS, ((1, 1), (1, 3), (5, 2), (5, 17)))
ACROSS = Sizes(2, ("wrap_cross_pole",), ((2, 2), (6, 10)))
EVEN = Sizes(2, (), ((2, 2), (4, 6), (6, 18)))
ANY = Sizes(1, (), ((1, 1), (1, 3), (5, 2), (3, 17)))


def _operation(
    name: str,
    build: Callable[[Builder, Sizes], dict[str, list[str]]],
    sizes: Sizes,
    dtype: type[np.floating] = np.float32,
) -> Reference:
    """One graph with an operation in all its variants; everything it writes is an output."""
    builder = Builder(name.replace("_", " "), sizes.multiple, "zero")
    variants = build(builder, sizes)
    written = {tensor: Symbol(tensor, 0) for node in builder.nodes for tensor in node.outputs}
    description = builder.build(written, {})
    random = np.random.RandomState(len(name))
    cases = {}
    for height, width in sizes.sizes:
        shapes = {x.name: (x.channels, height, width) for x in builder.inputs}
        inputs = {key: _uniform(random, shape, key) for key, shape in shapes.items()}
        cases[f"{height}x{width}"] = inputs
    for variant, names in variants.items():
        changed = {key: inputs[key].copy() for key in names}
        for values in changed.values():
            _CHANGES[variant](values)
        cases[f"{height}x{width}_{variant}"] = {**inputs, **changed}
    return Reference(name, description.graph, initial_weights(description, seed=2), cases, dtype)


def _uniform(random: np.random.RandomState, shape: tuple[int, ...], name: str) -> np.ndarray:
    if name == "c":  # sparse, and of few values, so that some are equal
        return np.maximum(random.randint(-8, 9, shape), 0) / 8
    if name == "depth":
        return random.randint(-20, 100, shape) / 8
    if name == "positive":
        return random.uniform(1e-6, 4, shape)
    return random.uniform(-2, 2, shape)


def _forget(values: np.ndarray) -> None:
    values[:] = 0


def _spoil(values: np.ndarray) -> None:
    """Inserts NaN and infinity, so far apart that no kernel covers both."""
    values[0, 0, 0] = np.nan
    values[-1, values.shape[1] // 2, values.shape[2] // 2] = np.inf


_CHANGES: dict[str, Callable[[np.ndarray], None]] = {
    "no_confidence": _forget,
    "not_finite": _spoil,
}


def _convolution(b: Builder, sizes: Sizes) -> dict[str, list[str]]:
    """Few channels, as an image has, and some that fill no block of 16 or 32."""
    for name, x, outputs in (("few", b.input("few", 3), 17), ("many", b.input("many", 18), 20)):
        for size in (1, 3, 5):
            layer = b.layer(Layer(f"{name}{size}", (outputs, x.channels, size, size)))
            for stride in (1, 2):
                for padding in sizes.paddings:
                    y = Symbol(f"{layer.name}_stride{stride}_{padding}", outputs, stride // 2)
                    b.node("convolution", [x], [y], layer, stride=stride, padding=padding)
    return {"not_finite": ["few", "many"]}


def _deep_convolution(b: Builder, sizes: Sizes) -> dict[str, list[str]]:
    """So many channels that `nn` multiplies in bytes; they fill no block."""
    x = b.input("deep", 18)
    for size in (1, 3, 5):
        layer = b.layer(Layer(f"deep{size}", (37, x.channels, size, size)))
        for stride in (1, 2):
            for padding in sizes.paddings:
                y = Symbol(f"{layer.name}_stride{stride}_{padding}", 37, stride // 2)
                b.node("convolution", [x], [y], layer, stride=stride, padding=padding)
    return {}


def _of_bytes(reference: Reference) -> Reference:
    """With ranges that some of the inputs, from -2 to 2, exceed, and one of which begins at zero."""
    names = [node.name for node in reference.graph.nodes]
    ranges = {name: (-1.5 * (i > 0), 1.9 + i / 16) for i, name in enumerate(names)}
    return replace(reference, ranges=ranges)


def _normalized_convolution(b: Builder, sizes: Sizes) -> dict[str, list[str]]:
    pair = Pair(b.input("x", 3), b.input("c", 3))
    for size, outputs in ((1, 1), (3, 2), (5, 2), (7, 4)):
        layer = b.normalized_layer(f"n{size}", 3, outputs, size)
        for b.padding in sizes.paddings:
            b.normalized_convolution(f"n{size}_{b.padding}", pair, layer)
    return {"no_confidence": ["c"], "not_finite": ["x"]}


def _pooling(b: Builder, _: Sizes) -> dict[str, list[str]]:
    pair = Pair(b.input("x", 3), b.input("c", 3))
    for rule in ("quarter", "sqrt"):
        b.confidence_pool(rule, pair, rule)
    b.average_pool("average", b.input("wide", 18))
    return {"no_confidence": ["c"], "not_finite": ["x", "wide"]}


def _upsampling(b: Builder, sizes: Sizes) -> dict[str, list[str]]:
    wide, x, weights = b.input("wide", 18), b.input("x", 1), b.input("weights", 36)
    affinity = b.slice("affinity", weights, 9, 9)
    b.upsample_nearest("nearest", wide)
    for b.padding in sizes.paddings:
        b.upsample_bilinear(f"bilinear_{b.padding}", wide)
        b.convex_upsample(f"convex_{b.padding}", x, weights)
        b.convex_filter(f"filter_{b.padding}", x, affinity)
    return {"not_finite": ["wide", "x"]}


def _elementwise(b: Builder, _: Sizes) -> dict[str, list[str]]:
    x, y, positive = b.input("wide", 18), b.input("wider", 18), b.input("positive", 3)
    for op in ("relu", "tanh", "sigmoid", "softplus", "exp"):
        b.pointwise(op, op, x)
    b.pointwise("log", "log", positive)
    b.pointwise("leaky_relu", "leaky_relu", x, slope=0.2)
    b.pointwise("clamp", "clamp", x, minimum=-0.5, maximum=1.25)
    b.pointwise("affine", "affine", x, scale=-3.0, offset=0.5)
    b.pointwise("add", "add", x, y)
    b.pointwise("multiply", "multiply", x, y)
    b.concatenate("concatenate", positive, x, y)
    b.slice("slice_of_a_block", x, 16, 2)
    b.slice("slice_across_blocks", x, 5, 12)
    return {"not_finite": ["wide", "positive"]}


def _panorama(b: Builder, _: Sizes) -> dict[str, list[str]]:
    """Operations on the whole image, or on the position of a pixel in it."""
    depth, c, wide = b.input("depth", 1), b.input("c", 1), b.input("wide", 18)
    b.median_log("median_log", depth, c)
    b.latitude_sine("latitude", wide)
    mean = b.global_average_pool("mean", wide)
    b.dense("dense2", b.dense("dense1", mean, 7, slope=0.1), 1)
    return {"no_confidence": ["c"], "not_finite": ["depth", "c"]}
