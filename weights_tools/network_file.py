"""Network files as docs/formats/network.md describes them: HDF5 behind a header with a digest.

The same network gives the same bytes: no time stamps, one order, one version of the format.
"""

import hashlib
import json
import math
import struct
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np
from torch import Tensor, as_tensor

from weights_tools.graph import Graph, run
from weights_tools.quantization import Ranges, rounded_convolutions

_HEADER_BYTES = 512  # the smallest user block that HDF5 has
_MAGIC = b"ORB360NN"
_VERSION = 1

Arrays = Mapping[str, np.ndarray]


class NetworkFile(NamedTuple):
    graph: Graph
    weights: dict[str, np.ndarray]

    def run(self, inputs: Mapping[str, Tensor], ranges: Ranges | None = None) -> dict[str, Tensor]:
        """Every tensor of the network by name, in the inputs' data type; with the convolutions that have
        a range in 8-bit integers."""
        dtype = next(iter(inputs.values())).dtype
        weights = {name: as_tensor(values).to(dtype) for name, values in self.weights.items()}
        return run(self.graph, weights, inputs, instead=rounded_convolutions(self.graph, ranges or {}))


def write(
    path: Path,
    graph: Graph,
    weights: Arrays,
    dtype: type[np.floating] = np.float32,
    tensors: Mapping[str, Arrays] | None = None,
    ranges: Ranges | None = None,
) -> None:
    """Writes weights as `dtype`; with them the ranges that a calibration found; and, for tests, tensors
    by case and name."""
    temporary = path.with_name(path.name + ".tmp")
    try:
        # The oldest format has no time stamps in groups.
        with h5py.File(
            temporary, "w", libver=("earliest", "v108"), userblock_size=_HEADER_BYTES
        ) as file:
            _write_text(file, "graph", graph.to_json())
            group = file.create_group("weights")
            for name, values in sorted(_narrow(weights, dtype).items()):
                group.create_dataset(name, data=values, track_times=False)
            if ranges:
                _write_text(file, "quantization", _ranges_json(ranges))
            if tensors:
                _write_tensors(file, tensors)
        _write_checksum(temporary)
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


def _write_text(file: h5py.File, name: str, text: str) -> None:
    content = text.encode()
    string = np.array(content, h5py.string_dtype("utf-8", len(content)))
    file.create_dataset(name, data=string, track_times=False)


def _ranges_json(ranges: Ranges) -> str:
    pairs = {name: [float(end) for end in ends] for name, ends in sorted(ranges.items())}
    return json.dumps({"input_ranges": pairs}, ensure_ascii=False, separators=(",", ":"))


def _write_tensors(file: h5py.File, tensors: Mapping[str, Arrays]) -> None:
    """One dataset of all numbers and what they are: HDF5 spends kilobytes on each dataset."""
    arrays = {
        (case, name): values
        for case, named in tensors.items()
        for name, values in _narrow(named, np.float32).items()
    }
    index = [
        {"case": case, "name": name, "shape": values.shape}
        for (case, name), values in arrays.items()
    ]
    _write_text(file, "tensors/index", json.dumps(index, separators=(",", ":")))
    file["tensors"].create_dataset(
        "values",
        data=np.concatenate([values.ravel() for values in arrays.values()]),
        track_times=False,
        compression="gzip",
        compression_opts=9,
        shuffle=True,
    )


def _write_checksum(path: Path) -> None:
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


def read_ranges(path: Path) -> dict[str, tuple[float, float]]:
    """The ranges of convolutions' inputs, if a calibration has added them."""
    _check_header(path)
    with h5py.File(path, "r") as file:
        if "quantization" not in file:
            return {}
        pairs = json.loads(file["quantization"][()].decode())["input_ranges"]
    return {name: (minimum, maximum) for name, (minimum, maximum) in pairs.items()}


def read_tensors(path: Path) -> dict[str, dict[str, np.ndarray]]:
    """Tensors by case and name, if the file has any."""
    _check_header(path)
    tensors: dict[str, dict[str, np.ndarray]] = {}
    with h5py.File(path, "r") as file:
        if "tensors" not in file:
            return tensors
        values, begin = file["tensors/values"][()], 0
        for entry in json.loads(file["tensors/index"][()]):
            end = begin + math.prod(entry["shape"])
            named = tensors.setdefault(entry["case"], {})
            named[entry["name"]] = values[begin:end].reshape(entry["shape"])
            begin = end
    return tensors


def _check_header(path: Path) -> None:
    content = path.read_bytes()
    magic, version, zero, digest = struct.unpack_from("<8sII32s", content.ljust(_HEADER_BYTES))
    if magic != _MAGIC or zero != 0:
        raise ValueError(f"{path}: is not a network of orb360")
    if version != _VERSION:
        raise ValueError(f"{path}: is of version {version}; this program reads {_VERSION}")
    if hashlib.sha256(content[_HEADER_BYTES:]).digest() != digest:
        raise ValueError(f"{path}: is damaged; write or copy it again")
