"""Adds to a network file the ranges of its convolutions' inputs, with which `nn` can multiply in 8-bit
integers (docs/formats/network.md): python3 -m weights_tools.quantize --help

The ranges come from running the network on packed drives, with 300 to 20,000 points.
"""

import argparse
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

import torch
from torch import Tensor

from weights_tools import network_file
from weights_tools.evaluation.given_points import points_of
from weights_tools.quantization import calibrate
from weights_tools.refusal import refusing
from weights_tools.training.batches import Frames, collate, plain

POINTS = ("300", "1000", "3000", "20000")


def samples(shards: Sequence[Path], every: int) -> Iterator[Mapping[str, Tensor]]:
    """Inputs of the network: of that many frames of each shard one, with each number of points in turn."""
    count = 0
    for path in shards:
        frames = Frames([path])
        for i in range(0, len(frames), every):
            points = points_of(frames[i], POINTS[count % len(POINTS)], i)
            count += 1
            if points is not None:
                yield collate([plain(frames[i], points)]).inputs


@refusing("quantize")
def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("network", type=Path, help="network file, which is written anew")
    parser.add_argument("shards", type=Path, nargs="+", help="packed drives of the network's width")
    parser.add_argument("--every", type=int, default=6, help="of that many frames one is used")
    parser.add_argument("--float", nargs="*", default=[], metavar="NODE", dest="excluded",
                        help="convolutions that stay floats")  # fmt: skip
    arguments = parser.parse_args()
    file = network_file.read(arguments.network)
    weights = {name: torch.as_tensor(values).float() for name, values in file.weights.items()}
    with torch.no_grad():
        ranges = calibrate(
            file.graph, weights, samples(arguments.shards, arguments.every), arguments.excluded
        )
    dtype = next(iter(file.weights.values())).dtype.type
    network_file.write(arguments.network, file.graph, file.weights, dtype, ranges=ranges)
    print(f"{len(ranges)} of {arguments.network}'s convolutions can multiply in 8 bits")


if __name__ == "__main__":
    main()
