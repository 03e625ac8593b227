"""Convolutions of bytes are plain sums of integers, and a calibration finds the ranges that lose least."""

import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import numpy as np
import torch

from tests.weights_tools import drives
from weights_tools import network_file, networks, quantization
from weights_tools.evaluation.given_points import points_of
from weights_tools.export import export
from weights_tools.network import Network
from weights_tools.training import shards
from weights_tools.training.batches import collate, plain

SOURCE = Path(__file__).resolve().parent.parent.parent
NARROW = (16, 18, 20, 22, 24)


class QuantizationTest(unittest.TestCase):
    def test_a_convolution_is_the_sum_of_rounded_numbers(self) -> None:
        random = np.random.RandomState(0)
        x = random.uniform(-2, 2, (14, 5, 6)).astype(np.float32)
        weight = random.uniform(-1, 1, (3, 14, 1, 1)).astype(np.float32)
        bias = random.uniform(-1, 1, 3).astype(np.float32)
        low, high = -1.5, 1.75
        result = quantization.convolution_of_bytes(
            torch.from_numpy(x)[None].double(),
            weight=torch.from_numpy(weight),
            bias=torch.from_numpy(bias),
            stride=1,
            padding="zero",
            range_of_input=(low, high),
        )[0].numpy()
        step = (high - low) / 255
        zero = round(-low / step)
        for o in range(3):
            unit = np.abs(weight[o]).max() / 127
            whole = np.rint(weight[o, :, 0, 0] / unit).astype(int)
            for row, column in ((0, 0), (2, 3), (4, 5)):
                bytes_ = np.clip(np.rint(x[:, row, column] / step) + zero, 0, 255).astype(int)
                expected = int(whole @ (bytes_ - zero)) * unit * step + bias[o]
                self.assertAlmostEqual(result[o, row, column], expected, places=5)

    def test_filters_keep_their_sums(self) -> None:
        weight = torch.from_numpy(np.random.RandomState(1).uniform(-1, 1, (8, 4, 3, 3)))
        rounded, step = quantization.round_weights(weight)
        self.assertEqual(rounded.abs().max(), 127)
        wanted = weight.sum((2, 3)) / step[:, None]
        self.assertLess((rounded.sum((2, 3)) - wanted).abs().max(), 0.501)

    def test_the_best_range_leaves_out_what_is_far_and_rare(self) -> None:
        values = np.random.RandomState(2).uniform(0, 1, 1_000_000).astype(np.float32)
        self.assertEqual(quantization.best_range(values)[0], 0)
        self.assertAlmostEqual(quantization.best_range(values)[1], values.max(), places=5)
        values[0] = 2
        low, high = quantization.best_range(values)
        self.assertLess(high, 1.3)
        self.assertGreater(high, 0.9)

    def test_an_input_that_is_never_positive_gets_no_range(self) -> None:
        network = Network(networks.coarse_depth_completion(NARROW, 16))
        weights = {name: value.detach().clone() for name, value in network.weights().items()}
        for role in ("weight", "bias"):
            weights[f"encoder1.{role}"].zero_()
        inputs = collate([plain(drives.frame(2), points_of(drives.frame(2), "1000", 0))]).inputs
        with torch.no_grad():
            ranges = quantization.calibrate(network.description.graph, weights, [inputs])
        self.assertNotIn("encoder2.linear", ranges)
        self.assertIn("head2", ranges)

    def test_a_calibrated_file_runs_near_its_floats(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            path, shard = Path(folder) / "network.h5", Path(folder) / "town1.npz"
            export(path, Network(networks.coarse_depth_completion(NARROW, 16)), {}, np.float16)
            before = network_file.read(path)
            self.assertEqual(network_file.read_ranges(path), {})
            shards.write(shard, shards.pack([drives.frame(0), drives.frame(1)]))
            subprocess.run(
                [sys.executable, "-m", "weights_tools.quantize", path, shard, "--every", "1"],
                cwd=SOURCE, check=True, stdout=subprocess.DEVNULL,
            )  # fmt: skip
            after = network_file.read(path)
            self.assertEqual(after.graph, before.graph)
            for name, values in before.weights.items():
                np.testing.assert_array_equal(after.weights[name], values)
            ranges = network_file.read_ranges(path)
            self.assertNotIn("encoder1.linear", ranges)  # which sees the image
            self.assertIn("encoder2.linear", ranges)
            inputs = collate([plain(drives.frame(2), points_of(drives.frame(2), "1000", 0))]).inputs
            floats, bytes_ = after.run(inputs), after.run(inputs, ranges)
            for port in after.graph.outputs:
                wanted, other = floats[port["tensor"]], bytes_[port["tensor"]]
                error = (other - wanted).abs().mean() / wanted.abs().mean()
                self.assertLess(error, 0.02, port["name"])
            self.assertFalse(torch.equal(floats["encoder2.linear"], bytes_["encoder2.linear"]))


if __name__ == "__main__":
    unittest.main()
