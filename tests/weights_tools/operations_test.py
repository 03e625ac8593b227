"""Operations against plain loops that read docs/formats/network.md literally."""

import itertools
import math
import unittest

import numpy as np
import torch

from weights_tools.operations import OPERATIONS
from weights_tools.padding import pad

PADDINGS = ("zero", "wrap_replicate", "wrap_cross_pole")
# One pixel; less than a 5x5 kernel reaches; odd; even (the only ones that cross poles).
SIZES = ((1, 1), (1, 2), (3, 2), (5, 7), (4, 6))


def random(*shape: int, low: float = -1.0, high: float = 1.0, seed: int = 0) -> torch.Tensor:
    return torch.from_numpy(np.random.RandomState(seed).uniform(low, high, shape))


def pixel(plane: np.ndarray, y: int, x: int, padding: str) -> float:
    height, width = plane.shape
    if padding == "zero":
        return plane[y, x] if 0 <= y < height and 0 <= x < width else 0.0
    if padding == "wrap_replicate":
        return plane[min(max(y, 0), height - 1), x % width]
    while not 0 <= y < height:
        y = -1 - y if y < 0 else 2 * height - 1 - y
        x += width // 2
    return plane[y, x % width]


def sizes_for(padding: str) -> list[tuple[int, int]]:
    return [s for s in SIZES if padding != "wrap_cross_pole" or s[1] % 2 == 0]


def correlate(x: np.ndarray, weight: np.ndarray, stride: int, padding: str) -> np.ndarray:
    """x: C x H x W; weight: O x C x k x k."""
    channels, height, width = x.shape
    half = weight.shape[-1] // 2
    rows, columns = -(-height // stride), -(-width // stride)
    y = np.zeros((weight.shape[0], rows, columns))
    for o, v, u, i in itertools.product(
        range(weight.shape[0]), range(rows), range(columns), range(channels)
    ):
        for dy, dx in itertools.product(range(-half, half + 1), repeat=2):
            tap = pixel(x[i], stride * v + dy, stride * u + dx, padding)
            y[o, v, u] += weight[o, i, dy + half, dx + half] * tap
    return y


class PadTest(unittest.TestCase):
    def test_every_padding_continues_the_image_however_small_it_is(self) -> None:
        for padding, width in itertools.product(PADDINGS, (0, 1, 2, 5)):
            for height, columns in sizes_for(padding):
                x = random(1, 1, height, columns)
                padded = pad(x, width, padding)[0, 0]
                for v, u in np.ndindex(*padded.shape):
                    expected = pixel(x[0, 0].numpy(), v - width, u - width, padding)
                    self.assertEqual(padded[v, u].item(), expected, (padding, width, v, u))

    def test_refuses_what_is_no_padding(self) -> None:
        with self.assertRaisesRegex(ValueError, '"mirror" is none of zero'):
            pad(random(1, 1, 2, 2), 1, "mirror")
        with self.assertRaisesRegex(ValueError, "needs an even width, not 3"):
            pad(random(1, 1, 2, 3), 1, "wrap_cross_pole")


class ConvolutionTest(unittest.TestCase):
    def test_is_the_sum_over_taps(self) -> None:
        for padding, size, stride in itertools.product(PADDINGS, (1, 3, 5), (1, 2)):
            weight, bias = random(3, 2, size, size, seed=1), random(3, seed=2)
            for height, width in sizes_for(padding):
                x = random(1, 2, height, width)
                y = OPERATIONS["convolution"](
                    x, weight=weight, bias=bias, stride=stride, padding=padding
                )
                expected = correlate(x[0].numpy(), weight.numpy(), stride, padding)
                expected += bias.numpy()[:, None, None]
                np.testing.assert_allclose(y[0].numpy(), expected, rtol=0, atol=1e-14)

    def test_dense_is_a_matrix_product(self) -> None:
        weight, bias, x = random(3, 5), random(3, seed=1), random(1, 5, 1, 1, seed=2)
        y = OPERATIONS["dense"](x, weight=weight, bias=bias)
        self.assertEqual(y.shape, (1, 3, 1, 1))
        for o in range(3):
            expected = sum(weight[o, i] * x[0, i, 0, 0] for i in range(5)) + bias[o]
            self.assertAlmostEqual(y[0, o, 0, 0].item(), expected.item(), places=14)


class NormalizedConvolutionTest(unittest.TestCase):
    def run_on(self, x: torch.Tensor, c: torch.Tensor, size: int, padding: str) -> None:
        weight, bias = random(3, 2, size, size, low=0, seed=3), random(3, seed=4)
        y, certainty = OPERATIONS["normalized_convolution"](
            x, c, weight=weight, bias=bias, padding=padding
        )
        numerator = correlate((x * c)[0].numpy(), weight.numpy(), 1, padding)
        denominator = correlate(c[0].numpy(), weight.numpy(), 1, padding)
        expected = numerator / (denominator + 1e-20) + bias.numpy()[:, None, None]
        sums = weight.numpy().sum(axis=(1, 2, 3))[:, None, None]
        np.testing.assert_allclose(y[0].numpy(), expected, rtol=0, atol=1e-14)
        np.testing.assert_allclose(certainty[0].numpy(), denominator / sums, rtol=0, atol=1e-15)

    def test_is_the_mean_weighted_by_confidence(self) -> None:
        for padding, size in itertools.product(PADDINGS, (1, 3, 5)):
            for height, width in sizes_for(padding):
                x, c = random(1, 2, height, width), random(1, 2, height, width, low=0, seed=1)
                self.run_on(x, c * (c > 0.7), size, padding)

    def test_is_the_bias_without_confidence_and_has_finite_derivatives(self) -> None:
        x = random(1, 1, 4, 6).requires_grad_()
        c = torch.zeros(1, 1, 4, 6, dtype=torch.float64, requires_grad=True)
        weight = random(2, 1, 3, 3, low=0.1).requires_grad_()
        bias = torch.tensor([0.25, -3.0], dtype=torch.float64)
        y, certainty = OPERATIONS["normalized_convolution"](
            x, c, weight=weight, bias=bias, padding="zero"
        )
        self.assertTrue((y == bias[None, :, None, None]).all())
        self.assertTrue((certainty == 0).all())
        y, certainty = OPERATIONS["confidence_pool"](y, certainty, rule="sqrt")
        (y.sum() + certainty.sum()).backward()
        for tensor in (x, c, weight):
            self.assertTrue(tensor.grad.isfinite().all())


class SizeTest(unittest.TestCase):
    def test_confidence_pool_takes_the_first_of_the_most_confident(self) -> None:
        x = torch.arange(16.0).view(1, 1, 4, 4)
        c = torch.tensor([[0, 0, 1, 2], [0, 0, 4, 4], [1, 3, 0, 9], [3, 3, 9, 0]])
        c = c[None, None].float()
        for rule, function in (("quarter", lambda v: v / 4), ("sqrt", math.sqrt)):
            value, certainty = OPERATIONS["confidence_pool"](x, c, rule=rule)
            self.assertEqual(value.flatten().tolist(), [0, 6, 9, 11])
            expected = torch.tensor([function(v) for v in (0, 4, 3, 9)])
            self.assertTrue(torch.equal(certainty.flatten(), expected))

    def test_pools_are_means(self) -> None:
        x = random(1, 2, 4, 6)
        y = OPERATIONS["average_pool"](x)
        for i, v, u in np.ndindex(2, 2, 3):
            mean = x[0, i, 2 * v : 2 * v + 2, 2 * u : 2 * u + 2].mean()
            self.assertAlmostEqual(y[0, i, v, u].item(), mean.item(), places=15)
        for i, mean in enumerate(OPERATIONS["global_average_pool"](x).flatten()):
            self.assertAlmostEqual(mean.item(), x[0, i].sum().item() / 24, places=15)

    def test_nearest_repeats(self) -> None:
        x = random(1, 2, 3, 5)
        y = OPERATIONS["upsample_nearest"](x)
        for i, v, u in np.ndindex(2, 6, 10):
            self.assertEqual(y[0, i, v, u], x[0, i, v // 2, u // 2])

    def test_bilinear_samples_between_pixel_centres(self) -> None:
        for padding in PADDINGS:
            for height, width in sizes_for(padding):
                x = random(1, 1, height, width)
                y = OPERATIONS["upsample_bilinear"](x, padding=padding)
                for v, u in np.ndindex(2 * height, 2 * width):
                    fy, fx = (v + 0.5) / 2 - 0.5, (u + 0.5) / 2 - 0.5
                    top, left = math.floor(fy), math.floor(fx)
                    expected = sum(
                        (1 - abs(fy - top - dy)) * (1 - abs(fx - left - dx))
                        * pixel(x[0, 0].numpy(), top + dy, left + dx, padding)
                        for dy, dx in itertools.product((0, 1), repeat=2)
                    )
                    self.assertAlmostEqual(y[0, 0, v, u].item(), expected, places=14)

    def test_bilinear_is_the_same_in_bfloat16(self) -> None:
        for padding in ("zero", "wrap_replicate"):
            for height, width in sizes_for(padding):
                x = random(2, 3, height, width).bfloat16().requires_grad_()
                exact = x.detach().double().requires_grad_()
                y = OPERATIONS["upsample_bilinear"](x, padding=padding)
                self.assertEqual(y.dtype, torch.bfloat16)
                expected = OPERATIONS["upsample_bilinear"](exact, padding=padding)
                np.testing.assert_allclose(y.detach().float(), expected.detach(), atol=1e-2)
                y.sum().backward()
                expected.sum().backward()
                np.testing.assert_allclose(x.grad.float(), exact.grad, atol=4e-2)

    def test_gradients_go_through_padding(self) -> None:
        for padding in PADDINGS:
            for width, size in itertools.product((1, 2), ((4, 6), (3, 2))):
                x = random(2, 2, *size).requires_grad_()
                last = x.detach().to(memory_format=torch.channels_last).requires_grad_()
                for values in (x, last):
                    padded = lambda v, w=width, p=padding: pad(v, w, p)
                    self.assertTrue(torch.autograd.gradcheck(padded, values))
                self.assertTrue(torch.equal(pad(x, width, padding), pad(last, width, padding)))

    def test_convex_upsampling_weighs_neighbours_by_the_softmax(self) -> None:
        for padding, factor in itertools.product(PADDINGS, (1, 2)):
            for height, width in sizes_for(padding):
                x = random(1, 1, height, width)
                weights = random(1, 9 * factor**2, height, width, high=3.0)
                y = OPERATIONS["convex_upsample"](x, weights, padding=padding, factor=factor)
                self.assertEqual(tuple(y.shape[2:]), (factor * height, factor * width))
                for v, u, i, j in np.ndindex(height, width, factor, factor):
                    first = 9 * (factor * i + j)
                    fractions = weights[0, first : first + 9, v, u].exp().tolist()
                    neighbours = [
                        pixel(x[0, 0].numpy(), v + dy, u + dx, padding)
                        for dy, dx in itertools.product((-1, 0, 1), repeat=2)
                    ]
                    expected = sum(map(math.prod, zip(fractions, neighbours))) / sum(fractions)
                    result = y[0, 0, factor * v + i, factor * u + j].item()
                    self.assertAlmostEqual(result, expected, places=14)


class ElementwiseTest(unittest.TestCase):
    def test_functions_of_one_number(self) -> None:
        cases = {
            "relu": ({}, lambda v: max(v, 0.0)),
            "leaky_relu": ({"slope": 0.2}, lambda v: v if v > 0 else 0.2 * v),
            "tanh": ({}, math.tanh),
            "sigmoid": ({}, lambda v: 1 / (1 + math.exp(-v))),
            "softplus": ({}, lambda v: math.log1p(math.exp(v)) if v < 30 else v),
            "exp": ({}, math.exp),
            "clamp": ({"minimum": -0.5, "maximum": 2.0}, lambda v: min(max(v, -0.5), 2.0)),
            "affine": ({"scale": 3.0, "offset": -1.0}, lambda v: 3 * v - 1),
        }
        numbers = [-40.0, -1.5, -0.1, 0.0, 0.1, 1.5, 25.0]
        for name, (attributes, function) in cases.items():
            y = OPERATIONS[name](torch.tensor(numbers, dtype=torch.float64), **attributes)
            np.testing.assert_allclose(y, [function(v) for v in numbers], rtol=1e-14)
        y = OPERATIONS["log"](torch.tensor([1e-30, 0.5, 1.0, 7.0], dtype=torch.float64))
        np.testing.assert_allclose(y, [math.log(v) for v in (1e-30, 0.5, 1.0, 7.0)], rtol=1e-15)

    def test_functions_of_several_tensors(self) -> None:
        a, b = random(1, 2, 2, 3), random(1, 2, 2, 3, seed=1)
        self.assertTrue(torch.equal(OPERATIONS["add"](a, b), a + b))
        self.assertTrue(torch.equal(OPERATIONS["multiply"](a, b), a * b))
        both = OPERATIONS["concatenate"](a, b)
        self.assertTrue(torch.equal(OPERATIONS["slice"](both, first=2, count=2), b))
        self.assertTrue(torch.equal(OPERATIONS["slice"](both, first=1, count=1), a[:, 1:]))


class PanoramaTest(unittest.TestCase):
    def test_median_log_keeps_points_only(self) -> None:
        nan, inf = math.nan, math.inf
        depth = torch.tensor([[2.0, 8.0, 4.0, -1.0, 0.0, nan, inf, 16.0, 5.0, 5.0]])
        c = torch.tensor([[1.0, 0.5, 3.0, 1.0, 1.0, 1.0, 1.0, inf, 0.0, nan]])
        x, certainty, median = OPERATIONS["median_log"](depth[None, None], c[None, None])
        self.assertEqual(median.item(), 4.0)  # the lower one of 2, 4, 8, 16
        expected = [-math.log(2), math.log(2), 0, 0, 0, 0, 0, math.log(4), 0, 0]
        np.testing.assert_allclose(x.flatten(), expected, rtol=1e-6)
        self.assertEqual(certainty.flatten().tolist(), [1, 0.5, 1, 0, 0, 0, 0, 1, 0, 0])

    def test_median_log_has_a_median_for_each_image_of_a_batch(self) -> None:
        depth = torch.tensor([2.0, 8.0, 8.0, 0.0, 0.0, 0.0]).view(2, 1, 1, 3)
        x, certainty, median = OPERATIONS["median_log"](depth, torch.ones_like(depth))
        self.assertEqual(median.flatten().tolist(), [8.0, 1.0])
        self.assertTrue((x[1] == 0).all() and (certainty[1] == 0).all())

    def test_latitude_is_that_of_the_centre_of_the_row(self) -> None:
        sine = OPERATIONS["latitude_sine"](random(2, 3, 4, 5))
        self.assertEqual(sine.shape, (2, 1, 4, 5))
        for row, degrees in enumerate((67.5, 22.5, -22.5, -67.5)):
            expected = math.sin(math.radians(degrees))
            np.testing.assert_allclose(sine[:, :, row], np.full((2, 1, 5), expected), rtol=1e-14)


if __name__ == "__main__":
    unittest.main()
