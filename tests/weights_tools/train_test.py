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
from tests.weights_tools.networks_test import coarse
from tests.weights_tools.retrain_test import doubled
from weights_tools import network_file, networks
from weights_tools.export import export, trained
from weights_tools.network import Network
from weights_tools.training import batches, shards, train
from weights_tools.training.loss import losses, pixel_weights, predicted_depth, relative_error, total
from weights_tools.training.optimizers import make_optimizers
from weights_tools.training.sparse_points import NoiseModel
from weights_tools.training.validate import error_cut, validate

SOURCE = Path(__file__).resolve().parent.parent.parent
CPU = torch.device("cpu")
# The part of the network that takes images as small as those of the drives.
COARSE = "coarse_depth_completion"


class Fixed(torch.nn.Module):
    """Stands for a network that says what it is told to."""

    def __init__(self, tensors: dict[str, torch.Tensor]) -> None:
        super().__init__()
        self.description = networks.depth_completion()
        self._tensors = tensors

    def tensors(self, _: dict[str, torch.Tensor], bfloat16: bool) -> dict[str, torch.Tensor]:
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

    def perfect(
        self, batch: batches.Batch, error: float, odds: float, ground_odds: float = 0.0
    ) -> Fixed:
        scale = torch.full_like(batch.scale, 3.0)
        truth = torch.where(batch.truth > 0, batch.truth, 1.0)
        exact = (truth * batch.scale / scale).log()
        return Fixed(
            {
                "log_depth": exact + error,
                "propagated": exact - 2 * error,
                "points.median": scale,
                "log_odds": torch.cat(
                    [torch.full_like(exact, odds), ground_odds * (2 * batch.ground - 1)], dim=1
                ),
                "completed.c": torch.full_like(exact, odds).sigmoid(),
                "ground": (ground_odds * (2 * batch.ground - 1)).sigmoid(),
                "global2": (scale / batch.scale / drives.CAMERA_HEIGHT).log() + 3 * error,
            }
        )

    def test_losses_are_errors_of_the_logarithm(self) -> None:
        batch = self.batch()
        for error in (0.0, 0.25):
            terms = losses(self.perfect(batch, error, 0.0), batch)
            for name, factor in (("propagated", 2), ("metric", 3)):
                self.assertAlmostEqual(terms[name].item(), factor * error, places=5)
            depth = (error + np.expm1(error)) / 2
            self.assertAlmostEqual(terms["depth"].item(), depth, places=5)

    def test_relative_error_is_that_of_ranges_and_straight_beyond_a_factor_of_e(self) -> None:
        ratio = torch.tensor([0.1, 0.8, 1.0, 1.25, 2.5], dtype=torch.float64)
        torch.testing.assert_close(relative_error(ratio.log()), (ratio - 1).abs())
        far = torch.tensor([1.0, 2.0, 5.0], dtype=torch.float64)
        expected = np.e - 1 + np.e * (far - 1)
        torch.testing.assert_close(relative_error(far), expected)

    def test_the_ground_is_learned_from_its_odds(self) -> None:
        batch = self.batch()
        self.assertTrue(0.3 < batch.ground.mean() < 0.5)
        unsure, sure, wrong = (
            losses(self.perfect(batch, 0.1, 0.0, odds), batch)["ground"].item()
            for odds in (0.0, 5.0, -5.0)
        )
        self.assertAlmostEqual(unsure, np.log(2), places=5)
        self.assertAlmostEqual(sure, np.log1p(np.exp(-5)), places=5)
        self.assertAlmostEqual(wrong, 5 + np.log1p(np.exp(-5)), places=5)

    def test_confidence_in_the_sky_is_that_of_an_error_as_large_as_the_range(self) -> None:
        batch = self.batch()
        batch.truth.zero_()
        values = {
            odds: losses(self.perfect(batch, 0.0, odds), batch)["confidence"].item()
            for odds in (-0.5, 0.0, 0.5)
        }
        self.assertEqual(min(values, key=values.get), 0.0)

    def test_confidence_is_best_where_it_tells_the_relative_error(self) -> None:
        batch = self.batch()
        batch.truth[batch.truth == 0] = 10.0  # no sky, which has a confidence of its own
        error = 0.5

        def loss(confidence: float) -> float:
            odds = float(np.log(confidence / (1 - confidence)))
            network = self.perfect(batch, float(np.log1p(error)), odds)
            return losses(network, batch)["confidence"].item()

        of_the_logarithm = 1 / (1 + np.log1p(error))
        best = min((0.6, 1 / (1 + error), of_the_logarithm, 0.8), key=loss)
        self.assertEqual(best, 1 / (1 + error))

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
        depth = predicted_depth(network(batch.inputs))
        self.assertTrue((depth > 0).all())

    def test_training_makes_the_loss_smaller(self) -> None:
        network = coarse()
        optimizers = make_optimizers(network, 2e-3, 0, bfloat16=False)
        batch = self.batch()
        history = []
        for _ in range(40):
            network.zero_grad()
            loss = total(losses(network, batch))
            loss.backward()
            for optimizer in optimizers:
                optimizer.step()
            history.append(loss.item())
        self.assertLess(history[-1], 0.6 * history[0])

    def run_training(self, folder: str, until: int | None = None) -> Network:
        settings = train.Settings(COARSE, steps=4, batch=1, warm_up=2, seed=3, checkpoint_every=2)
        paths = [self.shard]
        with contextlib.redirect_stdout(io.StringIO()):
            return train.train(settings, self.folder / folder, paths, paths, CPU, until=until)

    def test_an_interrupted_training_ends_as_one_in_one_piece(self) -> None:
        whole = self.run_training("whole")
        self.run_training("pieces", until=1)
        pieces = self.run_training("pieces")
        for (name, ours), theirs in zip(whole.named_parameters(), pieces.parameters()):
            self.assertTrue(torch.equal(ours, theirs), name)
        with (self.folder / "whole/log.csv").open() as file:
            lines = list(csv.DictReader(file))
        self.assertEqual([line["step"] for line in lines], ["2", "4"])
        terms = ("depth", "confidence", "propagated", "metric", "ground")
        unseen = ("absrel", "delta1", "scale_error", "ground_overlap", "error_cut")
        for name in (*terms, *(f"unseen_{name}" for name in unseen)):
            self.assertTrue(np.isfinite(float(lines[0][name])), name)

        # What was trained can be exported, and says where it comes from.
        network, provenance, width = trained(self.folder / "pieces/checkpoint.pt")
        self.assertEqual(width, drives.WIDTH)
        self.assertEqual(provenance["steps_done"], 4)
        self.assertEqual(provenance["shards"], ["street.npz"])
        self.assertEqual(provenance["earlier"], [])
        export(self.folder / "network.h5", network, provenance, width=width)
        graph, weights = network_file.read(self.folder / "network.h5")
        self.assertEqual(graph.normalisation["width"], drives.WIDTH)
        for name, values in whole.weights().items():
            np.testing.assert_array_equal(weights[name], values.detach().numpy())

        # Other settings, or other shards, would make another network of it.
        same = train.Settings(COARSE, steps=4, batch=1, warm_up=2, seed=3, checkpoint_every=2)
        other = replace(same, seed=4)
        for settings, paths in ((other, [self.shard]), (same, [self.shard] * 2)):
            with self.assertRaisesRegex(ValueError, "checkpoint.pt: was made with other"):
                train.train(settings, self.folder / "pieces", paths, [], CPU)

    def test_a_stage_goes_on_with_the_mean_of_another(self) -> None:
        settings = train.Settings("propagation", 3, batch=1, warm_up=1, rate=1e-2)
        paths, folder = [self.shard], self.folder / "propagation"
        with contextlib.redirect_stdout(io.StringIO()):
            first = train.train(settings, folder, paths, [], CPU)
            checkpoint = folder / "checkpoint.pt"
            settings = train.Settings(COARSE, steps=1, batch=1, bfloat16=True, fixed_propagation=True)
            second = self.folder / "second"
            network = train.train(settings, second, paths, [], CPU, [checkpoint])
        weights = network.weights()
        for name, values in first.weights().items():
            np.testing.assert_allclose(weights[name], values, rtol=1e-5, err_msg=name)
        untrained = Network(networks.propagation()).weights()
        self.assertFalse(torch.equal(weights["n1.weight"], untrained["n1.weight"]))
        _, provenance, _ = trained(second / "checkpoint.pt")
        (stage,) = provenance["earlier"]
        self.assertEqual((stage["network"], stage["steps_done"]), ("propagation", 3))

    def test_a_training_goes_on_from_a_network_file(self) -> None:
        self.run_training("first", until=1)
        network, provenance, width = trained(self.folder / "first/checkpoint.pt")
        path = self.folder / "network.h5"
        export(path, network, provenance, width=width)
        settings = train.Settings(COARSE, batch=1)
        training = train.Training(settings, [self.shard], self.folder / "on", CPU, [path])
        expected = network.weights()
        for name, values in training.network.weights().items():
            torch.testing.assert_close(values, expected[name], rtol=1e-4, atol=1e-6)
        (stage,) = training.stages
        self.assertEqual((stage["steps_done"], stage["shards"]), (1, ["street.npz"]))

    def test_only_the_layers_that_are_named_are_trained(self) -> None:
        self.run_training("first", until=1)
        start = self.folder / "first/checkpoint.pt"
        before = trained(start)[0].weights()
        settings = train.Settings(
            COARSE, steps=2, batch=1, warm_up=1, only="head", batch_normalization=True
        )
        with contextlib.redirect_stdout(io.StringIO()):
            network = train.train(settings, self.folder / "on", [self.shard], [], CPU, [start])
        self.assertEqual(list(network.normalizations), ["head1"])
        again = trained(self.folder / "on/checkpoint.pt")[0].weights()
        for name, values in network.weights().items():
            changed = not torch.allclose(values, before[name], rtol=1e-5, atol=1e-7)
            self.assertEqual(changed, name.startswith("head"), name)
            self.assertTrue(torch.equal(values, again[name]))

    def test_a_refinement_is_trained_whole_and_goes_on_with_all_the_rest(self) -> None:
        shard = self.folder / "large.npz"
        shards.write(shard, shards.pack([doubled(drives.frame())]))
        common = {"steps": 2, "batch": 1, "warm_up": 1, "fixed_propagation": True}
        common["batch_normalization"] = True
        start = Network(networks.depth_completion(), 0).weights()
        settings = train.Settings(only="refined", **common)
        with contextlib.redirect_stdout(io.StringIO()):
            alone = train.train(settings, self.folder / "alone", [shard], [], CPU)
        for name, values in alone.weights().items():
            changed = not torch.allclose(values, start[name], rtol=1e-6, atol=1e-9)
            self.assertEqual(changed, name.startswith("refined"), name)
        checkpoint = self.folder / "alone/checkpoint.pt"
        whole = train.Training(
            train.Settings(**common), [shard], self.folder / "all", CPU, [checkpoint]
        )
        trainable = {n for n, v in whole.network.named_parameters() if v.requires_grad}
        self.assertIn("layers.refined_shared.weight", trainable)
        self.assertIn("layers.encoder1.weight", trainable)
        self.assertNotIn("layers.n1.weight", trainable)
        # The layers that had no normalization begin with one that changes nothing.
        inputs = batches.draw(batches.Frames([shard]), 0, 2, 1, NoiseModel()).inputs
        expected = trained(checkpoint)[0](inputs)["log_depth"]
        found = whole.network.eval()(inputs)["log_depth"]
        self.assertLess((found - expected).abs().max().item(), 1e-2)

    def test_batches_are_normalized_from_where_a_network_file_is(self) -> None:
        self.run_training("first", until=1)
        network, provenance, width = trained(self.folder / "first/checkpoint.pt")
        path = self.folder / "network.h5"
        export(path, network, provenance, width=width)
        settings = train.Settings(COARSE, batch=1, batch_normalization=True)
        training = train.Training(settings, [self.shard], self.folder / "on", CPU, [path])
        inputs, at_first = self.batch().inputs, training.network.eval()
        self.assertTrue(at_first.normalizations)
        for name, values in network(inputs).items():
            torch.testing.assert_close(at_first(inputs)[name], values, rtol=1e-3, atol=1e-4)

    def test_layers_that_see_more_than_before_go_on_as_before(self) -> None:
        values, like = torch.rand(4, 2, 3, 3), torch.rand(4, 3, 3, 3)
        wide = train._widened(values, like)
        self.assertEqual(wide.shape, like.shape)
        x = torch.rand(1, 3, 8, 8)
        torch.testing.assert_close(
            torch.conv2d(x, wide), torch.conv2d(x[:, :2], values), rtol=1e-5, atol=1e-6
        )

    def test_the_mean_of_weights_follows_them(self) -> None:
        folder = self.folder / "mean"
        settings = train.Settings("propagation", 2, batch=1, warm_up=1, rate=1e-2)
        training = train.Training(settings, [self.shard], folder, CPU)
        name = "layers.n1.weight"
        seen = [training.network.state_dict()[name].clone()]
        for batch in training.batches(2):
            training.advance(batch)
            seen.append(training.network.state_dict()[name].clone())
        expected = seen[0].lerp(seen[1], 10 / 11).lerp(seen[2], 10 / 12)
        found = training.mean.state_dict()[name]
        np.testing.assert_allclose(found, expected, rtol=1e-6)
        self.assertFalse(torch.equal(found, seen[2]))

    def test_validation_measures_what_it_says(self) -> None:
        frames = batches.Frames([self.shard])
        factor = 1.3

        class Scaled(torch.nn.Module):
            """Knows the truth, but for a factor on half of the image, and finds no ground."""

            description = networks.depth_completion()
            knows_any_unit = True

            def tensors(self, inputs: dict[str, torch.Tensor], _: bool) -> dict[str, torch.Tensor]:
                truth = torch.from_numpy(drives.street())[None, None]
                known = inputs["depth"] > 0
                # The scale of the map: exact for most of the points.
                ratio = torch.where(known, inputs["depth"] / truth, torch.nan)
                scale = ratio.flatten(1).nanmedian(dim=1).values[:, None, None, None]
                log_depth = torch.where(truth > 0, truth, 1.0).log().repeat(len(scale), 1, 1, 1)
                log_depth[..., : drives.WIDTH // 2] += np.log(factor)
                certain = torch.ones_like(log_depth)
                certain[..., : drives.WIDTH // 4] = 0.5
                metric = torch.full_like(scale, -np.log(drives.CAMERA_HEIGHT) + 0.5)
                return {
                    "log_depth": log_depth,
                    "points.median": scale,
                    "completed.c": certain,
                    "global2": metric,
                    "ground": torch.zeros_like(log_depth),
                }

        measured = validate(Scaled(), frames, CPU)
        # The median of the points' noise disturbs the scale that is found.
        self.assertAlmostEqual(measured["absrel"], 0.15, delta=0.03)
        self.assertAlmostEqual(measured["delta1"], 0.5, delta=0.1)
        self.assertAlmostEqual(measured["scale_error"], 0.5, delta=0.05)
        self.assertEqual(measured["ground_overlap"], 0)
        # A fifth of the pixels, all of them among the wrong half: sqrt(0.3 / 0.8 / 0.5).
        self.assertAlmostEqual(measured["error_cut"], 1 - np.sqrt(0.75), delta=0.03)

    def test_error_falls_only_where_confidence_tells_it(self) -> None:
        random = np.random.RandomState(0)
        relative = torch.from_numpy(np.abs(random.standard_normal(20000)))
        truth = torch.from_numpy(random.uniform(0.1, 80, 20000))
        weight = torch.ones(20000)
        unrelated = torch.from_numpy(random.uniform(size=20000))
        self.assertAlmostEqual(error_cut(relative, unrelated, truth, weight), 0, delta=0.03)
        # Without the upper fifth of a normal distribution its RMS is 0.66.
        self.assertAlmostEqual(error_cut(relative, -relative, truth, weight), 0.34, delta=0.03)
        # What only tells how far a pixel is says nothing within a bin of range.
        self.assertAlmostEqual(error_cut(relative, -truth, truth, weight), 0, delta=0.03)

    def test_the_rate_rises_and_falls(self) -> None:
        settings = replace(train.Settings(), steps=100, warm_up=10, rate=1.0)
        rates = [train.learning_rate(settings, step) for step in range(101)]
        self.assertEqual(rates[0], 0.1)
        self.assertEqual(max(rates), rates[10])
        self.assertAlmostEqual(rates[100], 0.01)
        self.assertEqual(rates[10:], sorted(rates[10:], reverse=True))

    def test_damaged_and_foreign_files_are_refused_in_one_line(self) -> None:
        self.run_training("first", until=1)
        checkpoint = self.folder / "first/checkpoint.pt"
        older = torch.load(checkpoint)
        del older["optimizers"]
        torch.save(older, self.folder / "older.pt")
        torch.save({"weights": 1}, self.folder / "foreign.pt")
        (self.folder / "text").write_text("no checkpoint, no shard")
        (self.folder / "half.pt").write_bytes(checkpoint.read_bytes()[:-1000])
        (self.folder / "half.npz").write_bytes(self.shard.read_bytes()[:-1000])
        np.save(self.folder / "array.npy", np.zeros(3))
        for name in ("half.npz", "array.npy", "text"):
            with self.assertRaisesRegex(ValueError, f"{name}: is no shard of frames"):
                shards.read(self.folder / name)
        for name in ("half.pt", "foreign.pt", "text"):
            with self.assertRaisesRegex(ValueError, f"{name}: is no checkpoint"):
                train.read_checkpoint(self.folder / name, CPU)
        (self.folder / "older.pt").replace(checkpoint)
        with self.assertRaisesRegex(ValueError, "checkpoint.pt: comes from an older version"):
            self.run_training("first")
        # The command says the same and has no traceback.
        command = [sys.executable, "-m", "weights_tools.training.train", self.folder / "other"]
        command += ["--shards", self.folder / "half.npz"]
        done = subprocess.run(command, cwd=SOURCE, capture_output=True, text=True)
        self.assertNotEqual(done.returncode, 0)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("half.npz: is no shard of frames", done.stderr)

    def test_training_needs_only_numpy_and_pytorch(self) -> None:
        code = "import sys; sys.modules.update(h5py=None, cv2=None, yaml=None);"
        code += "import weights_tools.training.train"
        subprocess.run([sys.executable, "-c", code], cwd=SOURCE, check=True)


if __name__ == "__main__":
    unittest.main()
