"""Writes what the tests of `nn` compare with: networks and every tensor of their runs.

    python3 -m weights_tools.dump_reference                   # into tests/nn/data
    python3 -m weights_tools.dump_reference --full --out DIR  # networks too large to be kept
    python3 -m weights_tools.dump_reference --networks weights/*.h5 --out DIR  # from files

Each file is a network file whose group /tensors holds inputs and results, of large tensors the
first channels. They are computed in double precision and without oneDNN from the weights as they
are stored, then rounded: the same bytes every time.
"""

import argparse
from functools import partial
from pathlib import Path

import numpy as np
import torch

from weights_tools import network_file
from weights_tools.reference_cases import Arrays, Reference, full_networks, references, stored
from weights_tools.refusal import refusing

DATA = Path(__file__).resolve().parent.parent / "tests/nn/data"

# Results that only move numbers of others.
_COPIES = ("concatenate", "slice", "upsample_nearest")
# Numbers of a tensor that are kept, in whole channels, where it is no output of its network.
_LARGEST = 1024


def dump(reference: Reference, folder: Path, outputs_only: bool = False) -> Path:
    """Writes a file. What the network computes on the way is kept for the first case, or, with
    `outputs_only`, only what the nodes of the outputs read: errors are measured by its norm."""
    graph = reference.graph
    weights = {name: values.astype(reference.dtype) for name, values in reference.weights.items()}
    network = network_file.NetworkFile(graph, weights)
    outputs = {port["tensor"] for port in graph.outputs}
    whole = {port["name"] for port in graph.inputs} | outputs
    if outputs_only:
        whole |= {name for node in graph.nodes if outputs & set(node.outputs) for name in node.inputs}
    copies = {name for node in graph.nodes if node.op in _COPIES for name in node.outputs}

    def channels(name: str, values: np.ndarray) -> int:
        if name in whole:
            return len(values)
        return 0 if kept or outputs_only or name in copies else _LARGEST // values[0].size

    kept: dict[str, Arrays] = {}
    for case, inputs in reference.cases.items():
        # Inputs as they will be stored.
        stored = {name: values.astype(np.float32) for name, values in inputs.items()}
        given = {name: torch.from_numpy(v).double()[None] for name, v in stored.items()}
        with torch.backends.mkldnn.flags(enabled=False), torch.no_grad():
            run = partial(network.run, ranges=reference.ranges)
            tensors = {name: _plain(values[0]) for name, values in run(given).items()}
        parts = {name: values[: channels(name, values)] for name, values in tensors.items()}
        kept[case] = {name: values for name, values in parts.items() if len(values) > 0}
    path = folder / f"{reference.name}.h5"
    network_file.write(path, graph, weights, reference.dtype, kept, reference.ranges)
    return path


def _plain(values: torch.Tensor) -> np.ndarray:
    """Replaces every NaN by one kind, because the bits of a NaN depend on the processor."""
    return np.where(values.isnan(), np.nan, values.numpy())


@refusing("dump_reference")
def main() -> None:
    parser = argparse.ArgumentParser(description="Writes the references of the tests of nn.")
    parser.add_argument("--out", type=Path, default=DATA, help="folder (default: tests/nn/data)")
    parser.add_argument(
        "--full", action="store_true", help="the networks with all their channels, outputs only"
    )
    parser.add_argument("--networks", type=Path, nargs="+", help="these files, outputs only")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)
    torch.set_num_threads(1)  # sums in one order
    outputs_only = True
    if arguments.networks:
        chosen = [stored(path) for path in arguments.networks]
    elif arguments.full:
        chosen = full_networks()
    else:
        chosen, outputs_only = references(), False
    for reference in chosen:
        path = dump(reference, arguments.out, outputs_only)
        print(f"{path}: {path.stat().st_size} bytes")


if __name__ == "__main__":
    main()
