"""The project's own networks, as descriptions, and all networks by name.

Widths are parameters so that tests can run small copies; the defaults are the networks themselves.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

from weights_tools.builder import Builder, Description, Pair, Symbol
from weights_tools.published_networks import (
    encoder_decoder,
    image_and_points,
    multi_stream,
    unguided,
)

# Units of inputs and outputs, for people who read a file.
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


def depth_completion(
    widths: Sequence[int] = (32, 64, 96, 128, 160),
    hidden: int = 64,
    refined: int = 32,
    padding: str = "wrap_replicate",
) -> Description:
    """The project's own: 2.48 million parameters, 5.6 GMAC at 512 x 1024.

    What needs to see far works at half of the size (`coarse_depth_completion`); its depth is then
    corrected by the points and sharpened by the whole image.
    """
    # 128 of the image's pixels are one at the last level, which must be even to cross the poles.
    b = Builder(
        "panoramic depth completion", 256 if padding == "wrap_cross_pole" else 128, padding
    )
    image, sparse = image_and_points(b)
    points, scale = b.median_log("points", sparse.x, sparse.c)
    # The rule takes the square root, which leaves the confidence itself.
    squared = Pair(points.x, b.pointwise("multiply", "points.squared", points.c, points.c))
    half_points = b.confidence_pool("points.half", squared, "sqrt")
    half_image = b.average_pool("image.half", image)
    coarse = _complete(b, half_points, half_image, widths, hidden)
    log_depth, odds = _refine(b, image, points, half_points, coarse, refined)
    return _build_completion(b, log_depth, odds, scale, coarse.log_metric_scale)


def coarse_depth_completion(
    widths: Sequence[int] = (32, 64, 96, 128, 160),
    hidden: int = 64,
    padding: str = "wrap_replicate",
) -> Description:
    """The part of depth_completion that works at half of the size: 2.46 million parameters."""
    multiple = 128 if padding == "wrap_cross_pole" else 64
    b = Builder("coarse panoramic depth completion", multiple, padding)
    image, sparse = image_and_points(b)
    points, scale = b.median_log("points", sparse.x, sparse.c)
    coarse = _complete(b, points, image, widths, hidden)
    return _build_completion(b, coarse.log_depth, coarse.log_odds, scale, coarse.log_metric_scale)


class _Completion(NamedTuple):
    log_depth: Symbol
    log_odds: Symbol  # of the confidence and of the ground, at half of the size
    log_metric_scale: Symbol


def _complete(
    b: Builder, points: Pair, image: Symbol, widths: Sequence[int], hidden: int
) -> _Completion:
    """An encoder-decoder with the points as they are propagated, at the size of its inputs."""
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
    log_depth = b.convex_upsample("completed", coarse, b.slice("shares", heads, 4, 36))
    odds = b.slice("completed.odds", heads, 2, 2)

    x = b.global_average_pool("global.mean", encoded[-1])
    x = b.dense("global1", x, hidden, slope=_LEAK)
    log_metric_scale = b.dense("global2", x, 1, gain=_SMALL)
    return _Completion(log_depth, odds, log_metric_scale)


def _refine(
    b: Builder, image: Symbol, points: Pair, half_points: Pair, coarse: _Completion, width: int
) -> tuple[Symbol, Symbol]:
    """Spreads what the points differ by from a depth of half the size, and doubles its size. Also
    gives the odds, still of half the size: near points the depth errs less than before."""
    log_depth = coarse.log_depth
    against = b.pointwise("affine", "completed.negative", log_depth, scale=-1.0, offset=0.0)
    off = b.pointwise("add", "refined.difference", half_points.x, against)
    known = b.pointwise("multiply", "refined.known", off, half_points.c)
    seen = b.concatenate("refined.image", image, points.c)
    seen = b.convolution("refined1", seen, width - 8, stride=2, slope=_LEAK)
    x = b.concatenate("refined.features", seen, log_depth, known, half_points.c)
    x = b.convolution("refined2", x, width, slope=_LEAK)
    x = b.convolution("refined3", x, width, slope=_LEAK)
    heads = b.convolution("refined4", x, 2 + 36, size=1, gain=_SMALL)

    # A point counts as far as it is believed; its difference reaches as far as the other says.
    believed = b.pointwise("sigmoid", "refined.belief", b.slice("refined.odds", heads, 0, 1))
    believed = b.pointwise("multiply", "refined.points.c", half_points.c, believed)
    spread = _spread(b, Pair(off, believed))
    near = b.pointwise("clamp", "refined.clamped", spread.c, minimum=1e-8, maximum=1.0)
    near = b.pointwise("log", "refined.near", near)
    distance = b.convolution("refined5", near, 1, size=1)
    reach = b.pointwise("add", "refined.reach", b.slice("refined.far", heads, 1, 1), distance)
    reach = b.pointwise("sigmoid", "refined.share", reach)
    change = b.pointwise("multiply", "refined.change", reach, spread.x)
    refined = b.pointwise("add", "refined.corrected", log_depth, change)
    # Spatial propagation (Cheng, Wang, Yang, "Depth Estimation via Affinity Learned with Convolutional
    # Spatial Propagation Network"): edges move by up to a pixel in each step.
    affinity = b.convolution("refined7", x, 9, size=1, gain=_SMALL, prior=_KEEP)
    for i in range(_STEPS):
        refined = b.convex_filter(f"refined.step{i}", refined, affinity)
    refined = b.convex_upsample("log_depth", refined, b.slice("refined.shares", heads, 2, 36))

    odds = b.upsample_bilinear("log_odds.half", coarse.log_odds)
    certain, ground = (b.slice(f"log_odds.half{i}", odds, i, 1) for i in range(2))
    known = b.concatenate("refined.certainty", x, near, certain)
    more = b.convolution("refined6", known, 1, size=1, gain=_SMALL)
    certain = b.pointwise("add", "refined.certain", certain, more)
    return refined, b.concatenate("refined.log_odds", certain, ground)


def _spread(b: Builder, pair: Pair) -> Pair:
    """Means of what is known nearby. Each coarser level counts a quarter, so that the nearest
    points prevail."""
    first, shared = (b.normalized_layer(f"refined_{name}", 1, 1, 5) for name in ("first", "shared"))
    levels = [b.normalized_convolution("refined.level0", pair, first)]
    for i in range(1, 4):
        pooled = b.confidence_pool(f"refined.level{i}.pool", levels[-1], "quarter")
        levels.append(b.normalized_convolution(f"refined.level{i}", pooled, shared))
    return _merge(b, "refined_spread", levels)


def _build_completion(
    b: Builder, log_depth: Symbol, odds: Symbol, scale: Symbol, log_metric_scale: Symbol
) -> Description:
    likely = b.pointwise("sigmoid", "likely", b.upsample_bilinear("log_odds", odds))
    outputs = {
        "log_depth": log_depth,
        "confidence": b.slice("completed.c", likely, 0, 1),
        "scale": scale,
        "log_metric_scale": log_metric_scale,
        "ground": b.slice("ground", likely, 1, 1),
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
# Steps of spatial propagation, and the weights of a pixel's neighbourhood before training, as
# logarithms: most of it is its own.
_STEPS = 4
_KEEP = (0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0)
_LEVELS = 7  # fewer leave pixels of a panorama that see none of SLAM's points


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
    decoded = _merge(b, "propagated", levels)
    last = b.normalized_layer("propagated", 2, 1, 1)
    return b.normalized_convolution("propagated", decoded, last)


def _merge(b: Builder, name: str, levels: Sequence[Pair]) -> Pair:
    """Merges the levels of a pyramid, given from the finest on, beginning with the coarsest."""
    merged = levels[-1]
    for i, level in reversed(list(enumerate(levels[:-1]))):
        up = b.upsample_nearest_pair(f"{name}{i}.up", merged)
        both = b.concatenate_pairs(f"{name}{i}.concatenated", level, up)
        channels = level.x.channels
        layer = b.normalized_layer(f"{name}{i}", 2 * channels, channels, 3)
        merged = b.normalized_convolution(f"{name}{i}", both, layer)
    return merged


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
    "coarse_depth_completion": coarse_depth_completion,
    "propagation": propagation,
}
