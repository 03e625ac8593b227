"""Steps of convolutions are orthogonal, those of everything else AdamW's."""

import unittest
from collections.abc import Callable

import torch

from tests.weights_tools.networks_test import small
from weights_tools.training.optimizers import Muon, make_optimizers, orthogonal


def matrix(outputs: int, inputs: int, smallest: float) -> tuple[torch.Tensor, ...]:
    """U, singular values from 1 to `smallest`, and V, in double precision."""
    generator = torch.Generator().manual_seed(5)
    normal = torch.randn(outputs, inputs, generator=generator, dtype=torch.float64)
    u, _, vh = torch.linalg.svd(normal, full_matrices=False)
    return u, torch.linspace(1, smallest, min(outputs, inputs), dtype=torch.float64), vh.T


class OptimizersTest(unittest.TestCase):
    def test_the_orthogonal_matrix_keeps_the_singular_vectors_and_evens_the_values(self) -> None:
        for outputs, inputs in ((12, 40), (40, 12)):
            for kind, tolerance in ((torch.float32, 1e-5), (torch.bfloat16, 0.1)):
                u, values, v = matrix(outputs, inputs, 0.1)
                found = orthogonal((u * values @ v.T).to(kind)).double()
                inner = u.T @ found @ v
                self.assertTrue(((0.65 < inner.diag()) & (inner.diag() < 1.25)).all(), kind)
                self.assertLess((inner - inner.diag().diag()).abs().max(), tolerance)
                self.assertLess((found - u @ inner @ v.T).abs().max(), tolerance)

    def test_a_matrix_of_zeros_has_no_step(self) -> None:
        weight = torch.nn.Parameter(torch.ones(4, 2, 3, 3))
        weight.grad = torch.zeros_like(weight)
        Muon([weight], lr=0.1, weight_decay=0).step()
        self.assertTrue(torch.equal(weight, torch.ones_like(weight)))

    def test_the_size_of_a_step_is_the_rate_whatever_the_gradient(self) -> None:
        for outputs, inputs, scale in ((16, 4, 1.0), (16, 4, 1e-4), (4, 16, 1.0)):
            weight = torch.nn.Parameter(torch.zeros(outputs, inputs, 3, 3))
            weight.grad = scale * torch.randn(
                weight.shape, generator=torch.Generator().manual_seed(2)
            )
            Muon([weight], lr=0.01, weight_decay=0).step()
            size = weight.square().mean().sqrt().item()
            self.assertTrue(0.6 * 0.008 < size < 1.2 * 0.008, size)
            self.assertLess((weight * weight.grad).sum().item(), 0)

    def test_weights_decay_by_their_fraction_of_the_rate(self) -> None:
        weight = torch.nn.Parameter(torch.ones(4, 2, 3, 3))
        weight.grad = torch.zeros_like(weight)
        Muon([weight], lr=0.1, weight_decay=0.5).step()
        torch.testing.assert_close(weight.detach(), torch.full_like(weight, 0.95))

    def test_steps_reach_what_downhill_ones_leave_where_inputs_are_uneven(self) -> None:
        # Least squares whose inputs differ in size by a hundred, along no axis of the weights.
        generator = torch.Generator().manual_seed(3)
        axes, _ = torch.linalg.qr(torch.randn(18, 18, generator=generator))
        inputs = torch.randn(200, 18, generator=generator) * torch.logspace(0, -2, 18) @ axes.T
        true = torch.randn(4, 18, generator=generator)

        def left(make: Callable[[list[torch.nn.Parameter]], torch.optim.Optimizer]) -> float:
            weight = torch.nn.Parameter(torch.zeros(4, 2, 3, 3))
            optimizer = make([weight])
            rate = optimizer.param_groups[0]["lr"]
            for step in range(200):
                optimizer.param_groups[0]["lr"] = rate * (1 - step / 200)
                error = inputs @ (weight.flatten(1) - true).T
                optimizer.zero_grad()
                error.square().mean().backward()
                optimizer.step()
            off = (weight.detach().flatten(1) - true) @ axes
            return (off[:, :12].norm() / (true @ axes)[:, :12].norm()).item()

        muon = left(lambda weights: Muon(weights, lr=0.1, weight_decay=0))
        downhill = min(
            left(lambda weights, rate=rate: torch.optim.SGD(weights, rate)) for rate in (0.3, 1, 2)
        )
        self.assertLess(muon, 0.5 * downhill)

    def test_each_parameter_that_is_trained_belongs_to_one_optimizer(self) -> None:
        network = small()
        network.fix_propagation()
        muon, rest = make_optimizers(network, 1e-3, 0, bfloat16=False)
        self.assertIsInstance(muon, Muon)
        found = [id(p) for o in (muon, rest) for group in o.param_groups for p in group["params"]]
        trained = [id(p) for p in network.parameters() if p.requires_grad]
        self.assertEqual(sorted(found), sorted(trained))
        names = {id(p): name for name, p in network.named_parameters()}
        steps = {names[id(p)] for group in muon.param_groups for p in group["params"]}
        self.assertIn("layers.encoder1.weight", steps)
        self.assertIn("layers.head1.weight", steps)
        for other in ("n2.weight", "head2.weight", "global1.weight", "encoder1.bias"):
            self.assertNotIn(f"layers.{other}", steps)

    def test_normalized_convolutions_take_the_steps_of_adamw(self) -> None:
        network = small()
        muon, _ = make_optimizers(network, 1e-3, 0, bfloat16=False)
        names = {id(p): name for name, p in network.named_parameters()}
        steps = {names[id(p)] for group in muon.param_groups for p in group["params"]}
        self.assertIn("layers.propagated1.weight", names.values())
        self.assertNotIn("layers.propagated1.weight", steps)


if __name__ == "__main__":
    unittest.main()
