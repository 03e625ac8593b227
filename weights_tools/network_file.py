"""Network files as docs/networks.md describes them: HDF5 behind a header with a digest.

The same network gives the same bytes: no time stamps, one order, one version of the format.
"""

import hashlib
import os
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from torch import Tensor, as_tensor

from weights_tools.graph import Graph, run

_HEADER_BYTES = 512  # the smallest user block that HDF5 has
_MAGIC = b"ORB360NN"
_VERSION = 1

Arrays = Mapping[str, np.ndarray]


class NetworkFile(NamedTuple):
    graph: Graph
    weights: dict[str, np.ndarray]

    def run(self, inputs: Mapping[str, Tensor]) -> dict[str, Tensor]:
        """Every tensor of the network by name, in the inputs' data type."""
        dtype = next(iter(inputs.values())).dtype
        weights = {name: as_tensor(values).to(dtype) for name, values in self.weights.items()}
        return run(self.graph, weights, inputs)


def write(
    path: Path,
    graph: Graph,
    weights: Arrays,
    dtype: type[np.floating] = np.float32,
    tensors: Mapping[str, Arrays] | None = None,
) -> None:
    """Writes weights as `dtype`; and with them, for tests, tensors by case and name."""
    temporary = path.with_name(path.name + ".tmp")
    try:
        # The oldest format has no time stamps in groups.
        with h5py.File(
            temporary, "w", libver=("earliest", "v108"), userblock_size=_HEADER_BYTES
        ) as file:
            text = graph.to_json().encode()
            string = np.array(text, h5py.string_dtype("utf-8", len(text)))
            file.create_dataset("graph", data=string, track_times=False)
            _write_group(file, "weights", _narrow(weights, dtype))
            for case, arrays in (tensors or {}).items():
                packing = {"compression": "gzip", "compression_opts": 9, "shuffle": True}
                _write_group(file, f"tensors/{case}", _narrow(arrays, np.float32), **packing)
        _seal(temporary)
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def _narrow(arrays: Arrays, dtype: type[np.floating]) -> Arrays:
    with np.errstate(over="ignore"):
        narrow = {name: values.astype(dtype) for name, values in arrays.items()}
    for name, values in narrow.items():
        if np.isinf(values).sum() != np.isinf(arrays[name]).sum():
            raise ValueError(f'"{name}" has numbers that {dtype.__name__} cannot hold')
    return narrow


def _write_group(file: h5py.File, name: str, arrays: Arrays, **packing: object) -> None:
    group = file.create_group(name)
    for key, values in sorted(arrays.items()):
        group.create_dataset(key, data=values, track_times=False, **packing)


def _seal(path: Path) -> None:
    content = path.read_bytes()[_HEADER_BYTES:]
    header = struct.pack("<8sII32s", _MAGIC, _VERSION, 0, hashlib.sha256(content).digest())
    with path.open("r+b") as file:
        file.write(header)


def read(path: Path) -> NetworkFile:
    _check_header(path)
    with h5py.File(path, "r") as file:
        graph = Graph.from_json(file["graph"][()].decode())
        weights = {name: values[()] for name, values in file["weights"].items()}
    return NetworkFile(graph, weights)


def read_tensors(path: Path) -> dict[str, dict[str, np.ndarray]]:
    """Tensors by case and name, if the file has any."""
    _check_header(path)
    with h5py.File(path, "r") as file:
        return {
            case: {name: values[()] for name, values in group.items()}
            for case, group in file.get("tensors", {}).items()
        }


def _check_header(path: Path) -> None:
    content = path.read_bytes()
    magic, version, zero, digest = struct.unpack_from("<8sII32s", content.ljust(_HEADER_BYTES))
    if magic != _MAGIC or zero != 0:
        raise ValueError(f"{path}: is not a network of orb360")
    if version != _VERSION:
        raise ValueError(f"{path}: is of version {version}; this program reads {_VERSION}")
    if hashlib.sha256(content[_HEADER_BYTES:]).digest() != digest:
        raise ValueError(f"{path}: is damaged; write or copy it again")
