"""Files hold what was written, the same bytes every time, and damage is seen."""

import hashlib
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

import h5py
import numpy as np
import torch

from tests.weights_tools.networks_test import panorama, small
from weights_tools import network_file, networks
from weights_tools.export import export
from weights_tools.network import Network

SOURCE = Path(__file__).resolve().parent.parent.parent
REFERENCE = SOURCE.parent / "shared/reference/nconv_kitti_unguided_64x128.h5"


class NetworkFileTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.path = Path(folder.name) / "network.h5"

    def test_runs_as_the_network_that_was_written(self) -> None:
        network = small()
        export(self.path, network, {"seed": 1})
        graph, weights = file = network_file.read(self.path)
        self.assertEqual(graph.provenance, {"seed": 1})
        self.assertEqual(graph.nodes, network.description.graph.nodes)
        self.assertEqual(sum(w.size for w in weights.values()), network.description.parameters)
        inputs = panorama(dtype=torch.float32)
        tensors = file.run(inputs)
        for name, values in network.tensors(inputs).items():
            self.assertTrue(torch.equal(tensors[name], values), name)

    def test_the_same_network_gives_the_same_bytes_at_any_time(self) -> None:
        network = Network(networks.unguided())
        export(self.path, network, {})
        before = self.path.read_bytes()
        time.sleep(1.1)  # HDF5 counts time in seconds
        export(self.path, network, {})
        self.assertEqual(self.path.read_bytes(), before)
        self.assertEqual([path.name for path in self.path.parent.iterdir()], ["network.h5"])

    def test_halves_are_the_nearest_to_the_weights(self) -> None:
        network = Network(networks.unguided())
        export(self.path, network, {}, np.float16)
        for name, values in network_file.read(self.path).weights.items():
            self.assertEqual(values.dtype, np.float16)
            expected = network.weights()[name].detach().numpy().astype(np.float16)
            np.testing.assert_array_equal(values, expected)

    def test_says_what_images_it_expects_and_which_errors(self) -> None:
        network = Network(networks.unguided())
        export(self.path, network, {}, width=256, log_error=0.2)
        stated = network_file.read(self.path).graph.normalisation
        export(self.path, network, {})
        plain = network_file.read(self.path).graph.normalisation
        self.assertEqual(stated, {**plain, "width": 256, "log_error": 0.2})
        self.assertNotIn("log_error", plain)

    def test_refuses_weights_that_halves_cannot_hold(self) -> None:
        network = Network(networks.unguided())
        network.layers["n1"]["bias"].data[0] = 1e6
        with self.assertRaisesRegex(ValueError, '"n1.bias" has numbers that float16 cannot hold'):
            export(self.path, network, {}, np.float16)
        self.assertEqual(list(self.path.parent.iterdir()), [])

    def test_header_holds_magic_version_and_digest(self) -> None:
        export(self.path, Network(networks.unguided()), {})
        content = self.path.read_bytes()
        self.assertEqual(content[:16], b"ORB360NN" + bytes([1, 0, 0, 0, 0, 0, 0, 0]))
        self.assertEqual(content[16:48], hashlib.sha256(content[512:]).digest())
        self.assertEqual(content[48:512], bytes(464))

    def test_damage_is_seen_wherever_it_is(self) -> None:
        export(self.path, Network(networks.unguided()), {})
        content = self.path.read_bytes()
        for at, message in ((0, "is not a network"), (8, "is of version 0"), (20, "is damaged"),
                            (512, "is damaged"), (len(content) - 1, "is damaged")):
            damaged = bytearray(content)
            damaged[at] ^= 1
            self.path.write_bytes(damaged)
            with self.assertRaisesRegex(ValueError, message):
                network_file.read(self.path)
        for size in (0, 100, 512, len(content) - 1):
            self.path.write_bytes(content[:size])
            with self.assertRaises(ValueError):
                network_file.read(self.path)

    def test_tensors_travel_with_the_network(self) -> None:
        graph = networks.unguided().graph
        x = np.arange(6, dtype=np.float32).reshape(1, 2, 3)
        network_file.write(self.path, graph, {}, tensors={"2x3": {"x": x}, "other": {"x": 2 * x}})
        tensors = network_file.read_tensors(self.path)
        self.assertEqual(list(tensors), ["2x3", "other"])
        np.testing.assert_array_equal(tensors["2x3"]["x"], x)
        np.testing.assert_array_equal(tensors["other"]["x"], 2 * x)

    def test_command_line_writes_the_network_of_the_seed(self) -> None:
        command = [sys.executable, "-m", "weights_tools.export", str(self.path)]
        command += ["--untrained", "unguided", "--seed", "5"]
        subprocess.run(command, cwd=SOURCE, check=True)
        expected = Network(networks.unguided(), 5).weights()
        for name, values in network_file.read(self.path).weights.items():
            np.testing.assert_array_equal(values, expected[name].detach().numpy())


@unittest.skipUnless(REFERENCE.exists(), f"{REFERENCE} is not there")
class ReferenceTest(unittest.TestCase):
    """The published network with its authors' weights, as their own code ran it."""

    # Layer and role in the reference: {navg1.weight, bias1} and so on.
    LAYERS = {"n1": "1", "n2": "2", "n3": "3", "n4": "34", "n5": "23", "n6": "12", "n7": "4"}
    TENSORS = {
        "level0": "mid/{}1", "level1": "mid/{}2", "level2": "mid/{}3", "level3": "mid/{}4",
        "decoded0": "mid/{}12", "propagated": "out/{}",
    }

    def test_is_reproduced_node_by_node(self) -> None:
        with h5py.File(REFERENCE, "r") as file:
            weights = {}
            for layer, key in self.LAYERS.items():
                weights[f"{layer}.weight"] = file[f"w/navg{key}.weight"][()]
                weights[f"{layer}.bias"] = file[f"w/bias{key}"][()]
            inputs = {
                "depth": torch.from_numpy(file["in/x"][()]).double(),
                "confidence": torch.from_numpy(file["in/c"][()]).double(),
            }
            network = network_file.NetworkFile(networks.unguided().graph, weights)
            tensors = network.run(inputs)
            for name, key in self.TENSORS.items():
                for tensor, kind, metres in ((name, "x", 1e-4), (f"{name}.c", "c", 1e-6)):
                    expected = file[key.format(kind)][()]
                    self.assertEqual(tensors[tensor].shape, expected.shape)
                    worst = np.abs(tensors[tensor].numpy() - expected).max()
                    self.assertLess(worst, metres, tensor)


if __name__ == "__main__":
    unittest.main()
