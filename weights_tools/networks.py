"""The published networks and the project's own, as descriptions.

Widths are parameters so that tests can run small copies; the defaults are the networks themselves.
"""

from collections.abc import Callable, Sequence

from weights_tools.builder import Builder, Description, Layer, Pair, Symbol

# Units of inputs and outputs, for people who read a file.
METRES = {"image": "RGB in 0..1", "depth": "metres, 0 where unknown", "confidence": "0..1"}
LOG_DEPTH = {
    "image": "RGB in 0..1",
    "depth": "any unit, 0 where unknown",
    "confidence": "0..1",
    "log_depth": "ln of depth over scale",
    "scale": "median of the given depths",
    "error": "1 / confidence - 1 is the mean relative error of depth that is to be expected",
    "log_metric_scale": "ln of scale in heights of the camera",
    "ground": "probability of the road's plane under the camera",
}


def unguided() -> Description:
    """Confidence propagation without an image; Eldesokey et al. 2019: 481 parameters."""
    b = Builder("unguided normalized convolutions", 8, "zero")
    pair = _unguided(b, Pair(b.input("depth", 1), b.input("confidence", 1)))
    return b.build({"depth": pair.x, "confidence": pair.c}, METRES)


def _unguided(b: Builder, sparse: Pair) -> Pair:
    n1 = b.normalized_layer("n1", 1, 2, 5)
    n2, n3 = (b.normalized_layer(name, 2, 2, 5) for name in ("n2", "n3"))
    n4, n5, n6 = (b.normalized_layer(name, 4, 2, 3) for name in ("n4", "n5", "n6"))
    n7 = b.normalized_layer("n7", 2, 1, 1)

    level = b.normalized_convolution("level0.n1", sparse, n1)
    level = b.normalized_convolution("level0.n2", level, n2)
    level0 = b.normalized_convolution("level0", level, n3)
    level = b.confidence_pool("level1.pool", level0, "quarter")
    level = b.normalized_convolution("level1.n2", level, n2)
    level1 = b.normalized_convolution("level1", level, n3)
    level = b.confidence_pool("level2.pool", level1, "quarter")
    level2 = b.normalized_convolution("level2", level, n2)
    level = b.confidence_pool("level3.pool", level2, "quarter")
    level3 = b.normalized_convolution("level3", level, n2)

    def join(name: str, first: Pair, second: Pair, layer: Layer) -> Pair:
        both = b.concatenate_pairs(f"{name}.concatenated", first, second)
        return b.normalized_convolution(name, both, layer)

    up = b.upsample_nearest_pair("level3.up", level3)
    decoded = join("decoded2", level2, up, n4)
    up = b.upsample_nearest_pair("decoded2.up", decoded)
    decoded = join("decoded1", level1, up, n5)
    up = b.upsample_nearest_pair("decoded1.up", decoded)
    decoded = join("decoded0", up, level0, n6)  # the other order, as published
    return b.normalized_convolution("propagated", decoded, n7)


def encoder_decoder(encoder: int = 80, decoder: Sequence[int] = (64, 64, 32, 32)) -> Description:
    """Guided by the image from the first layer, as the paper describes it: 484,203 parameters."""
    b = Builder("guided encoder-decoder", 32, "zero")
    image, sparse = _image_and_points(b)
    propagated = _unguided(b, sparse)

    x = b.concatenate("fused", propagated.x, image, propagated.c)
    skips = []
    for i in range(1, 6):
        x = b.convolution(f"encoder{i}", x, encoder, stride=2, slope=0)
        skips.append(x)
    skips = [sparse.x, *skips[:-1]]
    for i, outputs in zip(range(4, -1, -1), [*decoder, 1], strict=True):
        up = b.upsample_nearest(f"decoder{i}.up", x)
        both = b.concatenate(f"decoder{i}.concatenated", up, skips[i])
        x = b.convolution(f"decoder{i}", both, outputs, slope=0.2)
    return b.build({"depth": x, "confidence": propagated.c}, METRES)


def multi_stream(depth: int = 16, image: int = 64, narrow: int = 32) -> Description:
    """Fuses depth and image late, at full resolution: 356,242 parameters."""
    b = Builder("guided multi-stream", 8, "zero")
    panorama, sparse = _image_and_points(b)
    propagated = _unguided(b, sparse)

    def stream(name: str, x: Symbol, widths: Sequence[int]) -> Symbol:
        for i, width in enumerate(widths, 1):
            x = b.convolution(f"{name}{i}", x, width, slope=0)
        return x

    coloured = b.concatenate("coloured", panorama, propagated.c)
    x = b.concatenate(
        "streams",
        stream("depth", propagated.x, [depth] * 6),
        stream("image", coloured, [image] * 6),
    )
    x = stream("joint", x, [image] * 3 + [narrow] * 3)
    x = b.convolution("completed", x, 1, size=1)
    return b.build({"depth": x, "confidence": propagated.c}, METRES)


def depth_completion(
    widths: Sequence[int] = (32, 64, 96, 128, 160),
    hidden: int = 64,
    padding: str = "wrap_replicate",
) -> Description:
    """The project's own: 2.46 million parameters, 12.39 GMAC at 512 x 1024."""
    # 64 of the image's pixels are one at the last level, which must be even to cross the poles.
    multiple = 128 if padding == "wrap_cross_pole" else 64
    b = Builder("panoramic depth completion", multiple, padding)
    image, sparse = _image_and_points(b)
    points, scale = b.median_log("points", sparse.x, sparse.c)
    propagated = _propagate(b, points)

    encoded = _encode(b, _features(b, points, propagated, image), widths)
    x = _decode(b, encoded)

    x = b.convolution("head1", x, x.channels, slope=_LEAK)
    heads = b.convolution("head2", x, 4 + 36, size=1, gain=_SMALL)
    # A depth of its own and how far to trust the propagated one instead: a sum of both would have
    # to undo, number by number, what propagation gets wrong.
    own, trust = b.slice("own", heads, 0, 1), b.slice("trust.odds", heads, 1, 1)
    against = b.pointwise("affine", "own.negative", own, scale=-1.0, offset=0.0)
    other = b.average_pool("propagated.half", propagated.x)
    other = b.pointwise("add", "propagated.more", other, against)
    other = b.pointwise("multiply", "trusted", other, b.pointwise("sigmoid", "trust", trust))
    coarse = b.pointwise("add", "coarse", own, other)
    log_depth = b.convex_upsample("log_depth", coarse, b.slice("shares", heads, 4, 36))
    odds = b.upsample_bilinear("log_odds", b.slice("log_odds.half", heads, 2, 2))
    likely = b.pointwise("sigmoid", "likely", odds)
    confidence, ground = b.slice("completed.c", likely, 0, 1), b.slice("ground", likely, 1, 1)

    x = b.global_average_pool("global.mean", encoded[-1])
    x = b.dense("global1", x, hidden, slope=_LEAK)
    log_metric_scale = b.dense("global2", x, 1, gain=_SMALL)
    outputs = {
        "log_depth": log_depth,
        "confidence": confidence,
        "scale": scale,
        "log_metric_scale": log_metric_scale,
        "ground": ground,
    }
    return b.build(outputs, LOG_DEPTH)


def propagation(padding: str = "wrap_replicate") -> Description:
    """The part of depth_completion that does not use the image."""
    b = Builder("panoramic confidence propagation", 64, padding)
    points, scale = b.median_log("points", b.input("depth", 1), b.input("confidence", 1))
    pair = _propagate(b, points)
    return b.build({"log_depth": pair.x, "confidence": pair.c, "scale": scale}, LOG_DEPTH)


_LEAK = 0.1  # slope of the activations below zero
# Gain of what is added to something else, before training: sums then keep the size of their parts,
# and with it the gradient. With 1 its norm was 90 at first, and training hardly got anywhere.
_SMALL = 0.1
_LEVELS = 7  # fewer leave pixels of a panorama that see none of SLAM's points


def _image_and_points(b: Builder) -> tuple[Symbol, Pair]:
    return b.input("image", 3), Pair(b.input("depth", 1), b.input("confidence", 1))


def _propagate(b: Builder, points: Pair) -> Pair:
    """A dense first estimate from the points alone, with its confidence."""
    first, second = b.normalized_layer("n1", 1, 2, 5), b.normalized_layer("n2", 2, 2, 5)
    shared = b.normalized_layer("n3", 2, 2, 5)
    level = b.normalized_convolution("level0.n1", points, first)
    levels = [b.normalized_convolution("level0", level, second)]
    for i in range(1, _LEVELS):
        # With the rule `quarter` hardly any confidence would remain at the last level.
        pooled = b.confidence_pool(f"level{i}.pool", levels[-1], "sqrt")
        levels.append(b.normalized_convolution(f"level{i}", pooled, shared))
    decoded = levels.pop()
    for i, skip in reversed(list(enumerate(levels))):
        up = b.upsample_nearest_pair(f"propagated{i}.up", decoded)
        both = b.concatenate_pairs(f"propagated{i}.concatenated", skip, up)
        layer = b.normalized_layer(f"propagated{i}", 4, 2, 3)
        decoded = b.normalized_convolution(f"propagated{i}", both, layer)
    last = b.normalized_layer("propagated", 2, 1, 1)
    return b.normalized_convolution("propagated", decoded, last)


def _features(b: Builder, points: Pair, propagated: Pair, image: Symbol) -> Symbol:
    """[z, 1 + log10(z's c) / 8 within 0 and 1, R, G, B, sin(latitude), ln(-sin(latitude)),
    (x - z) c, c], where x and c are the points'.

    Level ground at latitude l lies at camera height / -sin(l): but for a number that is the same
    everywhere, ln(-sin(l)) is the logarithm of its range. It ends one degree below the horizon.
    The points tell by how far they lie off what they propagate which of them are wrong, and keep
    what propagation smooths.
    """
    decades, ln_10 = 8, 2.302585092994046
    # Clamped before the logarithm, which then is finite and has a derivative.
    c = b.pointwise("clamp", "certainty.clamped", propagated.c, minimum=10.0**-decades, maximum=1.0)
    c = b.pointwise("log", "certainty.log", c)
    certainty = b.pointwise("affine", "certainty", c, scale=1 / (decades * ln_10), offset=1.0)
    latitude = b.latitude_sine("latitude", propagated.x)
    down = b.pointwise("affine", "down", latitude, scale=-1.0, offset=0.0)
    down = b.pointwise("clamp", "down.clamped", down, minimum=0.0175, maximum=1.0)
    level = b.pointwise("log", "level", down)
    against = b.pointwise("affine", "propagated.negative", propagated.x, scale=-1.0, offset=0.0)
    off = b.pointwise("add", "points.difference", points.x, against)
    off = b.pointwise("multiply", "points.off", off, points.c)
    parts = (propagated.x, certainty, image, latitude, level, off, points.c)
    return b.concatenate("features", *parts)


def _encode(b: Builder, x: Symbol, widths: Sequence[int]) -> list[Symbol]:
    """Halves the size five times; a residual block or two behind each but the first."""
    encoded = []
    for i, (width, blocks) in enumerate(zip(widths, (0, 1, 1, 2, 2), strict=True), 1):
        x = b.convolution(f"encoder{i}", x, width, stride=2, slope=_LEAK)
        for block in range(1, blocks + 1):
            x = _residual_block(b, f"encoder{i}_block{block}", x)
        encoded.append(x)
    return encoded


def _residual_block(b: Builder, name: str, x: Symbol) -> Symbol:
    inner = b.convolution(f"{name}_first", x, x.channels, slope=_LEAK)
    inner = b.convolution(f"{name}_second", inner, x.channels, gain=_SMALL)
    return b.activation(name, b.pointwise("add", f"{name}.sum", x, inner), _LEAK)


def _decode(b: Builder, encoded: Sequence[Symbol]) -> Symbol:
    """The decoder up to half the image's size, with skip connections from the encoder."""
    x = encoded[-1]
    for i, skip in reversed(list(enumerate(encoded[:-1], 1))):
        lateral = b.convolution(f"lateral{i}", x, skip.channels, size=1, gain=_SMALL)
        up = b.upsample_bilinear(f"lateral{i}.up", lateral)
        x = b.pointwise("add", f"decoder{i}.sum", skip, up)
        x = b.convolution(f"decoder{i}", x, x.channels, slope=_LEAK)
    return x


NETWORKS: dict[str, Callable[[], Description]] = {
    "unguided": unguided,
    "encoder_decoder": encoder_decoder,
    "multi_stream": multi_stream,
    "depth_completion": depth_completion,
    "propagation": propagation,
}
