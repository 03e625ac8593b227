"""The references of the tests of nn are what weights_tools computes today."""

import tempfile
import unittest
from pathlib import Path

import numpy as np
import torch

from weights_tools import network_file, networks
from weights_tools.dump_reference import DATA, dump
from weights_tools.operations import OPERATIONS
from weights_tools.reference_cases import full_networks, references


class DumpReferenceTest(unittest.TestCase):
    def test_gives_the_files_in_the_repository_byte_for_byte(self) -> None:
        expected = references()
        self.assertEqual(
            sorted(path.name for path in DATA.iterdir()), sorted(r.name + ".h5" for r in expected)
        )
        with tempfile.TemporaryDirectory() as folder:
            for reference in expected:
                path = dump(reference, Path(folder))
                kept = DATA / path.name
                if path.read_bytes() != kept.read_bytes():
                    self.fail(f"{path.name} is another one; {self.worst_difference(path, kept)}")

    def worst_difference(self, path: Path, kept: Path) -> str:
        ours, theirs = network_file.read_tensors(path), network_file.read_tensors(kept)
        worst = (0.0, "the tensors are equal")
        for case in ours:
            for name, values in ours[case].items():
                other = theirs.get(case, {}).get(name)
                if other is None or other.shape != values.shape:
                    return f"{case} {name} was not there or had another shape"
                difference = float(np.nan_to_num(np.abs(values - other)).max())
                worst = max(worst, (difference, f"{case} {name} differs by {difference}"))
        return worst[1]

    def test_files_are_small(self) -> None:
        self.assertLess(sum(path.stat().st_size for path in DATA.iterdir()), 3_000_000)

    def test_every_operation_is_there(self) -> None:
        operations = {node.op for r in references() for node in r.graph.nodes}
        self.assertEqual(operations, set(OPERATIONS))

    def test_single_precision_agrees(self) -> None:
        for reference in references():
            file = network_file.read(DATA / f"{reference.name}.h5")
            for case, kept in network_file.read_tensors(DATA / f"{reference.name}.h5").items():
                inputs = {
                    port["name"]: torch.from_numpy(kept[port["name"]])[None]
                    for port in file.graph.inputs
                }
                tensors = file.run(inputs, reference.ranges)
                for name, expected in kept.items():
                    values = tensors[name][0, : len(expected)].numpy()
                    finite = expected[np.isfinite(expected)]
                    size = np.abs(finite).max() if finite.size else 0
                    np.testing.assert_allclose(
                        values, expected, rtol=0, atol=1e-5 * max(size, 1e-3),
                        err_msg=f"{reference.name} {case} {name}",
                    )

    def test_large_networks_are_those_in_their_full_width(self) -> None:
        parameters = {
            reference.name: sum(values.size for values in reference.weights.values())
            for reference in full_networks()
        }
        for full in (networks.encoder_decoder, networks.multi_stream, networks.depth_completion):
            self.assertEqual(parameters[full.__name__], full().parameters)


if __name__ == "__main__":
    unittest.main()
