"""Writes a network to a file: python3 -m weights_tools.export --help"""

import argparse
import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import torch

from weights_tools import network_file
from weights_tools.network import Network
from weights_tools.networks import NETWORKS
from weights_tools.refusal import refusing
from weights_tools.training.train import checkpoint_network, read_checkpoint, stage


def export(
    path: Path,
    network: Network,
    provenance: Mapping[str, Any],
    dtype: type[np.floating] = np.float32,
    width: int | None = None,
    log_error: float | None = None,
) -> None:
    """Writes a network and its weights; `provenance` says where they come from, `width` which
    images it expects: `nn` resamples others. `log_error` is the relative error of ranges to be
    expected of a network whose confidence does not tell it."""
    stated = {"width": width, "log_error": log_error}
    graph = network.description.graph
    graph = dataclasses.replace(
        graph,
        provenance=dict(provenance),
        normalisation=graph.normalisation | {k: v for k, v in stated.items() if v is not None},
    )
    weights = {name: value.detach().cpu().numpy() for name, value in network.weights().items()}
    network_file.write(path, graph, weights, dtype)


def trained(checkpoint: Path) -> tuple[Network, dict[str, Any], int]:
    """The network of a checkpoint of weights_tools.training.train, its provenance, and the width of
    the images that it was trained on."""
    state = read_checkpoint(checkpoint, torch.device("cpu"))
    provenance = {**stage(state), "earlier": state["stages"]}
    return checkpoint_network(state), provenance, state["width"]


def untrained(name: str, seed: int) -> tuple[Network, dict[str, Any]]:
    return Network(NETWORKS[name](), seed), {"network": name, "steps": 0, "seed": seed}


@refusing("export")
def main() -> None:
    parser = argparse.ArgumentParser(description="Writes a network to a file.")
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--checkpoint", type=Path, help="of weights_tools.training.train")
    what.add_argument("--untrained", choices=NETWORKS, help="with the weights of a seed")
    parser.add_argument("out", type=Path, help="HDF5 file to write")
    parser.add_argument("--seed", type=int, default=0, help="of untrained weights (default: 0)")
    parser.add_argument("--log-error", type=float, metavar="E",
                        help="relative error of ranges, to be expected of a network whose confidence "
                        "does not tell it")  # fmt: skip
    parser.add_argument("--half", action="store_true", help="store weights as 16-bit floats")
    arguments = parser.parse_args()
    width = None
    if arguments.checkpoint:
        network, provenance, width = trained(arguments.checkpoint)
    else:
        network, provenance = untrained(arguments.untrained, arguments.seed)
    dtype = np.float16 if arguments.half else np.float32
    export(arguments.out, network, provenance, dtype, width, arguments.log_error)


if __name__ == "__main__":
    main()
