"""Normals of surfaces whose shape is known, and the term of the loss that they give."""

import unittest

import numpy as np
import torch

from weights_tools.training.loss import _normals, pixel_weights
from weights_tools.training.normals import surface_normals
from weights_tools.training.sphere import bearings

HEIGHT, WIDTH = 32, 64


def room() -> torch.Tensor:
    """The ranges of a room of 4 x 6 x 3 m, seen from its middle."""
    v, u = np.mgrid[0:HEIGHT, 0:WIDTH] + 0.5
    directions = np.abs(bearings(u, v, HEIGHT, WIDTH))
    return torch.from_numpy((np.array([2, 3, 1.5]) / directions).min(axis=-1)).float()[None, None]


class NormalsTest(unittest.TestCase):
    def test_walls_floor_and_ceiling_of_a_room_face_its_axes(self) -> None:
        normals = surface_normals(room())[0]
        self.assertEqual(normals.shape, (3, HEIGHT - 2, WIDTH))
        # Pixels whose neighbours lie on other walls lean; most do not.
        aligned = normals.abs().max(dim=0).values > 0.999
        self.assertGreater(aligned.float().mean().item(), 0.65)
        self.assertTrue(bool((normals[2, 0].abs() > 0.999).all()))  # the ceiling
        self.assertEqual(normals[2, 0].sign().unique().numel(), 1)
        self.assertTrue(bool((normals[2, 0] * normals[2, -1] < 0).all()))  # and the floor

    def test_the_term_is_zero_for_the_truth_and_for_any_other_scale(self) -> None:
        truth = room()
        weight = pixel_weights(truth)
        for scale in (0.0, 0.5):
            difference = torch.full_like(truth, scale)
            self.assertLess(_normals(difference, truth, weight).item(), 1e-5)

    def test_the_term_grows_with_the_roughness_of_a_surface_and_ignores_edges(self) -> None:
        truth = room()
        weight = pixel_weights(truth)
        noise = torch.randn(truth.shape, generator=torch.Generator().manual_seed(1))
        errors = [_normals(size * noise, truth, weight).item() for size in (0.01, 0.03, 0.1)]
        self.assertEqual(errors, sorted(errors))
        self.assertGreater(errors[0], 1e-4)
        step = truth.clone()
        step[..., WIDTH // 2 :] *= 3
        # Noise at the pixels beside the two steps only.
        difference = torch.zeros_like(step)
        for column in (0, WIDTH // 2 - 1, WIDTH // 2, WIDTH - 1):
            difference[..., column] = 0.2 * noise[..., column]
        beside = _normals(difference, step, weight).item()
        self.assertLess(beside, 0.5 * _normals(0.2 * noise, step, weight).item())
        self.assertGreater(_normals(difference, truth, weight).item(), beside)


if __name__ == "__main__":
    unittest.main()
