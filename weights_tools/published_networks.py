"""The published networks, as descriptions.

Widths are parameters so that tests can run small copies; the defaults are the networks themselves.
"""

from collections.abc import Sequence

from weights_tools.builder import Builder, Description, Layer, Pair, Symbol

# Units of inputs and outputs, for people who read a file.
METRES = {"image": "RGB in 0..1", "depth": "metres, 0 where unknown", "confidence": "0..1"}


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
    image, sparse = image_and_points(b)
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
    panorama, sparse = image_and_points(b)
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


def image_and_points(b: Builder) -> tuple[Symbol, Pair]:
    """Declares the inputs that all guided networks have."""
    return b.input("image", 3), Pair(b.input("depth", 1), b.input("confidence", 1))
