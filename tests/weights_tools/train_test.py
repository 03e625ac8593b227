"""Losses say what is wrong, training makes it less, and goes on where it was stopped."""

import contextlib
import csv
import io
import subprocess
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch

from tests.weights_tools import drives
from tests.weights_tools.networks_test import small
from weights_tools import network_file, networks
from weights_tools.export import export, trained
from weights_tools.network import Network
from weights_tools.training import batches, shards, train
from weights_tools.training.loss import losses, pixel_weights, predicted_depth, total
from weights_tools.training.sparse_points import NoiseModel

SOURCE = Path(__file__).resolve().parent.parent.parent
CPU = torch.device("cpu")


class Fixed(torch.nn.Module):
    """Stands for a network that says what it is told to."""

    def __init__(self, tensors: dict[str, torch.Tensor]) -> None:
        super().__init__()
        self.description = networks.depth_completion()
        self._tensors = tensors

    def tensors(self, _: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        return self._tensors


class TrainTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        self.shard = self.folder / "street.npz"
        shards.write(self.shard, shards.pack([drives.frame(0), drives.frame(1)]))
        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        self.addCleanup(torch.set_num_threads, threads)

    def batch(self) -> batches.Batch:
        return batches.draw(batches.Frames([self.shard]), 0, 0, 2, NoiseModel())

    def perfect(self, batch: batches.Batch, error: float, odds: float) -> Fixed:
        scale = torch.full_like(batch.scale, 3.0)
        truth = torch.where(batch.truth > 0, batch.truth, 1.0)
        exact = (truth * batch.scale / scale).log()
        return Fixed(
            {
                "log_depth": exact + error,
                "propagated": exact - 2 * error,
                "points.median": scale,
                "confidence.log_odds": torch.full_like(exact, odds),
                "completed.c": torch.full_like(exact, odds).sigmoid(),
                "global2": (scale / batch.scale / drives.CAMERA_HEIGHT).log() + 3 * error,
            }
        )

    def test_losses_are_errors_of_the_logarithm(self) -> None:
        batch = self.batch()
        for error in (0.0, 0.25):
            terms = losses(self.perfect(batch, error, 0.0), batch)
            for name, factor in (("depth", 1), ("propagated", 2), ("metric", 3)):
                self.assertAlmostEqual(terms[name].item(), factor * error, places=5)

    def test_confidence_is_best_where_it_tells_the_error(self) -> None:
        batch = self.batch()
        error = 0.05
        values = {
            confidence: losses(
                self.perfect(batch, error, float(np.log(confidence / (1 - confidence)))), batch
            )["confidence"].item()
            for confidence in (0.90, 0.94, 1 / (1 + error), 0.96, 0.99)
        }
        self.assertEqual(min(values, key=values.get), 1 / (1 + error))

    def test_only_surfaces_count_and_by_their_solid_angle(self) -> None:
        truth = torch.zeros(1, 1, 4, 2)
        truth[0, 0, 0, 0], truth[0, 0, 1, 1] = 5.0, 7.0
        weight = pixel_weights(truth)
        self.assertEqual((weight > 0).sum(), 2)
        ratio = weight[0, 0, 0, 0] / weight[0, 0, 1, 1]
        self.assertAlmostEqual(ratio.item(), np.cos(np.pi * 3 / 8) / np.cos(np.pi / 8), places=5)

    def test_published_networks_are_judged_by_relative_error(self) -> None:
        network = Network(networks.encoder_decoder(8, (8, 8, 8, 8)))
        batch = self.batch()
        terms = losses(network, batch)
        self.assertEqual(list(terms), ["depth"])
        depth = predicted_depth(network, batch.inputs)
        self.assertTrue((depth > 0).all())

    def test_training_makes_the_loss_smaller(self) -> None:
        network = small()
        optimizer = torch.optim.AdamW(network.parameters(), 2e-3)
        batch = self.batch()
        history = []
        for _ in range(40):
            optimizer.zero_grad()
            loss = total(losses(network, batch))
            loss.backward()
            optimizer.step()
            history.append(loss.item())
        self.assertLess(history[-1], 0.6 * history[0])

    def run_training(self, folder: str, until: int | None = None) -> Network:
        settings = train.Settings(steps=4, batch=1, warm_up=2, seed=3, checkpoint_every=2)
        paths = [self.shard]
        with contextlib.redirect_stdout(io.StringIO()):
            return train.train(settings, self.folder / folder, paths, paths, CPU, until)

    def test_an_interrupted_training_ends_as_one_in_one_piece(self) -> None:
        whole = self.run_training("whole")
        self.run_training("pieces", until=1)
        pieces = self.run_training("pieces")
        for (name, ours), theirs in zip(whole.named_parameters(), pieces.parameters()):
            self.assertTrue(torch.equal(ours, theirs), name)
        with (self.folder / "whole/log.csv").open() as file:
            lines = list(csv.DictReader(file))
        self.assertEqual([line["step"] for line in lines], ["2", "4"])
        for name in ("depth", "confidence", "propagated", "metric", "absrel", "delta1"):
            self.assertTrue(np.isfinite(float(lines[0][name])), name)

        # What was trained can be exported, and says where it comes from.
        network, provenance = trained(self.folder / "pieces/checkpoint.pt")
        self.assertEqual(provenance["steps"], 4)
        self.assertEqual(provenance["shards"], ["street.npz"])
        export(self.folder / "network.h5", network, provenance)
        weights = network_file.read(self.folder / "network.h5").weights
        for name, values in whole.weights().items():
            np.testing.assert_array_equal(weights[name], values.detach().numpy())

        # Other settings, or other shards, would make another network of it.
        same = train.Settings(steps=4, batch=1, warm_up=2, seed=3, checkpoint_every=2)
        other = replace(same, seed=4)
        for settings, paths in ((other, [self.shard]), (same, [self.shard] * 2)):
            with self.assertRaisesRegex(ValueError, "checkpoint.pt: was made with other"):
                train.train(settings, self.folder / "pieces", paths, [], CPU)

    def test_validation_measures_what_it_says(self) -> None:
        frames = batches.Frames([self.shard])
        factor = 1.3

        class Scaled(torch.nn.Module):
            """Knows the truth, but for a factor on half of the picture."""

            def forward(self, inputs: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
                truth = torch.from_numpy(drives.street())[None, None]
                known = inputs["depth"] > 0
                # The scale of the map: exact for most of the points.
                scale = (inputs["depth"] / truth)[known].median()
                depth = torch.where(truth > 0, truth, 1.0) * scale
                depth[..., : drives.WIDTH // 2] *= factor
                return {"depth": depth}

        measured = train.validate(Scaled(), frames, CPU)
        # The median of the points' noise disturbs the scale that is found.
        self.assertAlmostEqual(measured["absrel"], 0.15, delta=0.03)
        self.assertAlmostEqual(measured["delta1"], 0.5, delta=0.1)

    def test_the_rate_rises_and_falls(self) -> None:
        settings = replace(train.Settings(), steps=100, warm_up=10, rate=1.0)
        rates = [train.learning_rate(settings, step) for step in range(101)]
        self.assertEqual(rates[0], 0.1)
        self.assertEqual(max(rates), rates[10])
        self.assertAlmostEqual(rates[100], 0.01)
        self.assertEqual(rates[10:], sorted(rates[10:], reverse=True))

    def test_training_needs_only_numpy_and_pytorch(self) -> None:
        code = "import sys; sys.modules.update(h5py=None, cv2=None, yaml=None);"
        code += "import weights_tools.training.train"
        subprocess.run([sys.executable, "-c", code], cwd=SOURCE, check=True)


if __name__ == "__main__":
    unittest.main()
