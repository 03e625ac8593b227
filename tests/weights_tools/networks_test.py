"""The networks' sizes, and what must hold for every panorama they are given."""

import math
import unittest

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from weights_tools import networks
from weights_tools.builder import Builder, Description
from weights_tools.network import KEPT_SIZE, Network, initial_bound

HEIGHT, WIDTH = 128, 256
NARROW = (8, 12, 20, 24, 36)


def panorama(seed: int = 0, dtype: torch.dtype = torch.float64) -> dict[str, Tensor]:
    """A random image with 5 % of its depths."""
    random = np.random.RandomState(seed)
    known = random.uniform(size=(1, 1, HEIGHT, WIDTH)) < 0.05
    arrays = {
        "image": random.uniform(size=(1, 3, HEIGHT, WIDTH)),
        "depth": known * random.uniform(1, 80, known.shape),
        "confidence": known * random.uniform(0.1, 1, known.shape),
    }
    return {name: torch.from_numpy(values).to(dtype) for name, values in arrays.items()}


def small(padding: str = "wrap_replicate") -> Network:
    description = networks.depth_completion(NARROW, 10, refined=12, padding=padding)
    return Network(description, seed=1)


def coarse() -> Network:
    return Network(networks.coarse_depth_completion(NARROW, hidden=10), seed=1)


class SizeTest(unittest.TestCase):
    def check(self, description: Description, parameters: int, giga_macs: float) -> None:
        self.assertEqual(description.parameters, parameters)
        trainable = sum(values.numel() for values in Network(description).parameters())
        self.assertEqual(trainable, parameters)
        macs = sum(description.multiply_accumulates(512, 1024).values())
        self.assertEqual(round(macs / 1e9, 2), giga_macs)

    def test_unguided(self) -> None:
        self.check(networks.unguided(), 481, 0.42)

    def test_encoder_decoder(self) -> None:
        self.check(networks.encoder_decoder(), 484_203, 10.01)

    def test_multi_stream(self) -> None:
        self.check(networks.multi_stream(), 356_242, 186.54)

    def test_depth_completion(self) -> None:
        self.check(networks.depth_completion(), 2_483_585, 5.66)
        self.check(networks.coarse_depth_completion(), 2_463_944, 12.39)

    def test_layers_of_coarse_depth_completion_cost_what_was_planned(self) -> None:
        planned = {  # millions of multiply-accumulates at 512 x 1024
            "encoder1": 340, "encoder2": 604 + 2416, "encoder3": 453 + 1359, "encoder4": 227 + 1208,
            "encoder5": 94 + 472, "4": 313, "3": 705, "2": 1258, "1": 1275, "head": 1376,
        }
        counted = dict.fromkeys(planned, 0)
        for node, macs in networks.coarse_depth_completion().multiply_accumulates(512, 1024).items():
            part = node.partition(".")[0].partition("_")[0]
            part = part.replace("lateral", "").replace("decoder", "")
            part = "head" if part.startswith("head") else part
            if part in counted:
                counted[part] += macs
        for part, millions in planned.items():
            self.assertAlmostEqual(counted[part] / 1e6, millions, delta=1, msg=part)

    def test_costs_are_those_of_the_tensors_that_run(self) -> None:
        network = small().double()
        tensors = network.tensors(panorama())
        weights = network.weights()
        counted = network.description.multiply_accumulates(HEIGHT, WIDTH)
        for node in network.description.graph.nodes:
            if node.weights:
                pixels = tensors[node.outputs[0]][0, 0].numel()
                sums = 2 if node.op == "normalized_convolution" else 1
                expected = sums * pixels * weights[node.weights["weight"]].numel()
                self.assertEqual(counted[node.name], expected, node.name)

    def test_two_layers_cannot_have_one_name(self) -> None:
        builder = Builder("twice", 1, "zero")
        x = builder.convolution("a", builder.input("x", 1), 2)
        with self.assertRaisesRegex(ValueError, 'two layers named "a"'):
            builder.convolution("a", x, 2)


class SeedTest(unittest.TestCase):
    def test_the_same_seed_gives_the_same_weights(self) -> None:
        first, same, other = (Network(networks.unguided(), seed) for seed in (3, 3, 4))
        for name, weight in first.weights().items():
            self.assertTrue(torch.equal(weight, same.weights()[name]))
            self.assertFalse(torch.equal(weight, other.weights()[name]))

    def test_weights_of_normalized_convolutions_stay_positive(self) -> None:
        network = Network(networks.unguided())
        for values in network.parameters():
            values.data -= 3.0
        for name, weight in network.weights().items():
            if name.endswith("weight"):
                self.assertTrue((weight > 0).all())

    def test_weights_survive_loading(self) -> None:
        network, other = Network(networks.unguided(), 0), Network(networks.unguided(), 1)
        weights = {name: value.detach().numpy() for name, value in network.weights().items()}
        other.load(weights)
        for name, value in other.weights().items():
            np.testing.assert_allclose(value.detach(), weights[name], rtol=3e-7)
        with self.assertRaisesRegex(ValueError, 'layer "n1" of "unguided'):
            other.load({**weights, "n1.weight": weights["n2.weight"]})


class NormalizationTest(unittest.TestCase):
    def test_it_ends_up_in_the_weights(self) -> None:
        description = networks.depth_completion(NARROW, 10, refined=12)
        network = Network(description, 1, normalizes=True).double()
        self.assertIn("head1", network.normalizations)
        for name in ("head2", "lateral1", "n1", "global1"):
            self.assertNotIn(name, network.normalizations)
        random = np.random.RandomState(0)
        for norm in network.normalizations.values():
            for values, low in ((norm.weight, 0.5), (norm.bias, -1), (norm.running_mean, -1)):
                values.data = torch.from_numpy(random.uniform(low, 1, values.shape))
        inputs = panorama()
        in_training = network(inputs)["log_depth"]
        network.eval()
        before = network(inputs)["log_depth"]
        self.assertGreater((in_training - before).abs().max(), 1e-3)
        # What a file would hold does the same as layers with a normalization behind each.
        plain = Network(description).double()
        plain.load({name: value.detach().numpy() for name, value in network.weights().items()})
        self.assertLess((plain(inputs)["log_depth"] - before).abs().max(), 1e-10)
        # By hand, for one layer.
        norm = network.normalizations["encoder1"]
        x = torch.from_numpy(random.uniform(-1, 1, (2, 3, 6, 6)))
        weight, bias = (network.layers["encoder1"][role] for role in ("weight", "bias"))
        x = torch.cat([x, x, x], dim=1)  # nine channels
        expected = norm(torch.conv2d(x, weight, bias))
        weights = network.weights()
        found = torch.conv2d(x, weights["encoder1.weight"], weights["encoder1.bias"])
        self.assertLess((found - expected).abs().max(), 1e-12)

    def test_bfloat16_is_nearly_the_same(self) -> None:
        network = small()
        inputs = panorama(dtype=torch.float32)
        exact, short = (network.tensors(inputs, bfloat16=short) for short in (False, True))
        for name in ("log_depth", "completed.c", "ground", "global2"):
            self.assertEqual(short[name].dtype, torch.float32)
            difference = (exact[name] - short[name]).abs().max().item()
            self.assertLess(difference, 0.03, name)
            self.assertGreater(difference, 0, name)


class DepthCompletionTest(unittest.TestCase):
    def test_outputs_have_the_size_of_the_image(self) -> None:
        outputs = small().double()(panorama())
        for name in ("log_depth", "confidence", "ground"):
            self.assertEqual(outputs[name].shape, (1, 1, HEIGHT, WIDTH))
        for name in ("scale", "log_metric_scale"):
            self.assertEqual(outputs[name].shape, (1, 1, 1, 1))

    def test_the_encoder_sees_how_far_points_lie_off_what_they_propagate(self) -> None:
        tensors = coarse().double().tensors(panorama())
        off, confidence = tensors["features"][:, -2:-1], tensors["features"][:, -1:]
        point = tensors["depth"] > 0
        self.assertTrue(point.any() and not point.all())
        self.assertTrue(torch.equal(confidence > 0, point))
        x = (tensors["depth"] / tensors["points.median"]).clamp(min=1e-9).log()
        expected = torch.where(point, (x - tensors["propagated"]) * tensors["confidence"], 0.0)
        self.assertLess((off - expected).abs().max().item(), 1e-12)

    def test_of_the_points_in_a_square_the_most_confident_reaches_the_coarse_part(self) -> None:
        inputs = panorama()
        inputs["depth"][...] = torch.rand(inputs["depth"].shape, dtype=torch.float64) + 1
        inputs["confidence"][...] = torch.rand(inputs["confidence"].shape, dtype=torch.float64)
        tensors = small().double().tensors(inputs)
        confidence, index = F.max_pool2d(inputs["confidence"], 2, return_indices=True)
        depth = inputs["depth"].flatten(2).gather(2, index.flatten(2)).view_as(confidence)
        expected = (depth / tensors["points.median"]).log()
        self.assertLess((tensors["points.half"] - expected).abs().max().item(), 1e-12)
        self.assertLess((tensors["points.half.c"] - confidence).abs().max().item(), 1e-12)
        off = tensors["refined.difference"] + tensors["completed"] - expected
        self.assertLess(off.abs().max().item(), 1e-12)

    def test_turning_the_camera_turns_the_result(self) -> None:
        network = small().double()
        inputs = panorama()
        outputs = network(inputs)
        turned = network({name: value.roll(128, -1) for name, value in inputs.items()})
        for name in ("log_depth", "confidence", "ground"):
            # Not exact here: BLAS adds up in another order elsewhere in the image.
            difference = (outputs[name].roll(128, -1) - turned[name]).abs().max().item()
            self.assertLess(difference, 1e-12, name)
        self.assertEqual(outputs["scale"], turned["scale"])
        difference = (outputs["log_metric_scale"] - turned["log_metric_scale"]).abs().item()
        self.assertLess(difference, 1e-12)

    def test_the_unit_of_depth_does_not_matter(self) -> None:
        network = small().double()
        inputs = panorama()
        outputs = network(inputs)
        scaled = network({**inputs, "depth": inputs["depth"] * 0.1})
        for name in ("log_depth", "confidence", "log_metric_scale", "ground"):
            difference = (outputs[name] - scaled[name]).abs().max().item()
            self.assertLess(difference, 1e-13, name)
        self.assertAlmostEqual(scaled["scale"].item(), 0.1 * outputs["scale"].item())

    def test_is_finite_and_can_be_trained_without_points_and_without_a_image(self) -> None:
        inputs = panorama(dtype=torch.float32)
        for name in inputs:
            network = small("wrap_cross_pole")
            outputs = network({**inputs, name: torch.zeros_like(inputs[name])})
            sum(values.square().mean() for values in outputs.values()).backward()
            for value in outputs.values():
                self.assertTrue(value.isfinite().all())
            for parameter, values in network.named_parameters():
                self.assertTrue(values.grad.isfinite().all(), parameter)

    def test_every_parameter_matters(self) -> None:
        network = small().double()
        outputs = network(panorama())
        sum(values.square().sum() for values in outputs.values()).backward()
        for parameter, values in network.named_parameters():
            self.assertGreater(values.grad.abs().max().item(), 0.0, parameter)


class PublishedTest(unittest.TestCase):
    def test_a_lone_point_is_spread_over_94_pixels(self) -> None:
        network = Network(networks.unguided()).double()
        depth = torch.zeros(1, 1, 192, 192, dtype=torch.float64)
        depth[..., 96, 96] = 5.0
        certain = network({"depth": depth, "confidence": (depth > 0).double()})["confidence"]
        reached = certain[0, 0] > 0
        self.assertEqual(reached.any(dim=1).sum(), 94)
        self.assertEqual(reached.any(dim=0).sum(), 94)

    def test_guided_networks_start_from_the_unguided_one(self) -> None:
        inputs = panorama()
        alone = Network(networks.unguided()).double()
        propagated = alone({name: inputs[name] for name in ("depth", "confidence")})
        for describe in (networks.encoder_decoder, networks.multi_stream):
            guided = Network(describe()).double()
            weights = {name: w.detach() for name, w in alone.weights().items()}
            own = {name: w.detach() for name, w in guided.weights().items()}
            guided.load({**own, **weights})
            tensors = guided.tensors(inputs)
            difference = tensors["propagated"] - propagated["depth"]
            self.assertLess(difference.abs().max().item(), 1e-12)

    def test_loaded_filters_get_a_size_for_training_and_change_nothing(self) -> None:
        description = networks.coarse_depth_completion(NARROW, hidden=10)
        loaded = Network(description, seed=1).double()
        random = np.random.RandomState(0)
        for weight in loaded.inner_convolutions():  # as if they had taken in a normalization
            factor = np.exp(random.uniform(-3, 0, len(weight)))
            weight.data *= torch.from_numpy(factor)[:, None, None, None]
        inputs, weights = panorama(), {n: w.detach() for n, w in loaded.weights().items()}
        trained = Network(description, seed=2, normalizes=True).double()
        trained.load(weights)
        trained.double()
        trained.calibrate(inputs, list(trained.normalizations))
        layers = {layer.name: layer for layer in description.layers}
        for name in trained.normalizations:
            size = trained.layers[name]["weight"].square().mean(dim=(1, 2, 3)).sqrt()
            expected = KEPT_SIZE * initial_bound(layers[name]) / math.sqrt(3)
            torch.testing.assert_close(size, torch.full_like(size, expected))
        for expected, found in (
            (loaded(inputs), trained.eval()(inputs)),  # the statistics that it keeps
            (weights, trained.weights()),
            (loaded(inputs), trained.train()(inputs)),  # those of this batch
        ):
            for name, values in expected.items():
                torch.testing.assert_close(found[name], values, rtol=1e-4, atol=1e-5)

    def test_the_encoder_decoder_sees_the_raw_points_last(self) -> None:
        tensors = Network(networks.encoder_decoder()).double().tensors(panorama())
        last = tensors["decoder0.concatenated"]
        self.assertEqual(last.shape, (1, 33, HEIGHT, WIDTH))
        self.assertTrue(torch.equal(last[:, 32:], tensors["depth"]))
        expected = torch.cat([tensors[n] for n in ("propagated", "image", "propagated.c")], 1)
        self.assertTrue(torch.equal(tensors["fused"], expected))

    def test_certainty_is_the_logarithm_of_confidence_over_eight_decades(self) -> None:
        network = small().double()
        inputs = panorama()
        inputs["confidence"] *= 1e-7
        tensors = network.tensors(inputs)
        c = tensors["propagated.c"].clamp(min=1e-300)
        expected = (1 + c.log10() / 8).clamp(0, 1)
        difference = (tensors["certainty"] - expected).abs().max().item()
        self.assertLess(difference, 1e-14)
        self.assertGreater(math.log10(c.max().item()), -8)


if __name__ == "__main__":
    unittest.main()
