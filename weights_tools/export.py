"""Writes a network with seeded weights to a file: python3 -m weights_tools.export --help"""

import argparse
import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from weights_tools import network_file, networks
from weights_tools.network import Network

NETWORKS = {
    "unguided": networks.unguided,
    "encoder_decoder": networks.encoder_decoder,
    "multi_stream": networks.multi_stream,
    "depth_completion": networks.depth_completion,
}


def export(
    path: Path,
    network: Network,
    provenance: Mapping[str, Any],
    dtype: type[np.floating] = np.float32,
) -> None:
    """Writes a network and its weights; `provenance` says where they come from."""
    graph = dataclasses.replace(network.description.graph, provenance=dict(provenance))
    weights = {name: value.detach().cpu().numpy() for name, value in network.weights().items()}
    network_file.write(path, graph, weights, dtype)


def main() -> None:
    parser = argparse.ArgumentParser(description="Writes a network with untrained weights.")
    parser.add_argument("network", choices=NETWORKS)
    parser.add_argument("out", type=Path, help="HDF5 file to write")
    parser.add_argument("--seed", type=int, default=0, help="of the weights (default: 0)")
    parser.add_argument("--half", action="store_true", help="store weights as 16-bit floats")
    arguments = parser.parse_args()
    network = Network(NETWORKS[arguments.network](), arguments.seed)
    provenance = {"trained_on": "nothing", "seed": arguments.seed}
    export(arguments.out, network, provenance, np.float16 if arguments.half else np.float32)


if __name__ == "__main__":
    main()
