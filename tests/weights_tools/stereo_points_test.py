"""Simulated stereo measures what stereo can measure, as well as it states."""

import unittest
from dataclasses import replace

import numpy as np

from tests.weights_tools import drives
from weights_tools.training.sparse_points import SparsePoints
from weights_tools.training.sphere import bearings
from weights_tools.training.stereo_points import StereoNoise, simulate_stereo

# On every pixel with a surface, with errors too small to be seen. The image is one of 128 pixels.
EXACT = StereoNoise(
    points=(10**7, 10**7),
    grid=0,
    contrast=(1e-3, 1e-3),
    disparity=(1e-6, 1e-6),
    holes=(1e-9, 1e-9),
    fattened=(0.1, 0.1),
    wrong=(1e-9, 1e-9),
    sky=(1e-9, 1e-9),
    moving_kept=0,
    estimate_error=0,
)


def relative_errors(points: SparsePoints, truth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where points on surfaces are, and their relative errors there."""
    known = (points.depth > 0) & (truth > 0)
    return known, points.depth[known] / points.scale / truth[known] - 1


class StereoPointsTest(unittest.TestCase):
    def simulate(self, seed: int = 0, **changes: object) -> SparsePoints:
        return simulate_stereo(
            drives.frame(), np.random.RandomState(seed), replace(EXACT, **changes)
        )

    def test_without_noise_every_surface_has_its_range(self) -> None:
        points, truth = self.simulate(), drives.street()
        known, error = relative_errors(points, truth)
        self.assertGreater(known.sum(), 0.98 * (truth > 0).sum())
        self.assertLess(np.percentile(np.abs(error), 99), 1e-3)
        self.assertLess((points.depth > 0)[truth == 0].mean(), 0.01)

    def test_errors_are_those_of_disparity_and_as_large_as_stated(self) -> None:
        # Half a pixel of 1024 over a metre: 0.003 of the inverse range, less towards the way.
        truth, stated, found = drives.street(), [], []
        for seed in range(10):
            points = self.simulate(seed, disparity=(0.5, 0.5), baseline=(1, 1))
            known, error = relative_errors(points, truth)
            claimed = 0.1 * np.sqrt(1 / points.confidence[known] - 1)
            stated.append(claimed)
            found.append(error)
        stated, found = np.concatenate(stated), np.abs(np.concatenate(found))
        self.assertAlmostEqual(np.median(found / stated), 0.67, delta=0.05)
        v, u = np.nonzero(truth > 0)
        seen = bearings(u + 0.5, v + 0.5, drives.HEIGHT, drives.WIDTH)
        across = np.sqrt(1 - seen[:, 0] ** 2)  # of a baseline along the way, as most are
        expected = 0.5 * 2 * np.pi / 1024 * truth[v, u] / across
        self.assertAlmostEqual(np.median(stated) / np.median(expected), 1, delta=0.25)

    def test_neighbours_err_alike(self) -> None:
        points = self.simulate(disparity=(0.5, 0.5), baseline=(1, 1), common=0.9)
        truth = drives.street()
        known = (points.depth > 0) & (truth > 0)
        error = np.where(known, points.depth / points.scale / np.maximum(truth, 1e-3) - 1, 0)
        beside = known & np.roll(known, 1, axis=1)
        correlation = np.corrcoef(error[beside], np.roll(error, 1, axis=1)[beside])[0, 1]
        self.assertGreater(correlation, 0.4)

    def test_nothing_is_measured_without_contrast(self) -> None:
        frame = drives.frame()
        rgb = frame.rgb.copy()
        rgb[:, : drives.WIDTH // 2] = 128
        points = simulate_stereo(replace(frame, rgb=rgb), np.random.RandomState(0), EXACT)
        measured = points.depth > 0
        self.assertEqual(measured[:, 4 : drives.WIDTH // 2 - 4].sum(), 0)
        self.assertGreater(measured[:, drives.WIDTH // 2 + 4 : -4].sum(), 1000)

    def test_near_surfaces_grow_over_far_ones(self) -> None:
        truth = drives.street()
        frame = drives.frame()
        near = truth.copy()
        near[20:40, 60:70] = 0.5
        points = simulate_stereo(
            replace(frame, range=near), np.random.RandomState(0), replace(EXACT, fattened=(16, 16))
        )
        measured = points.depth / points.scale
        is_near = np.abs(measured - 0.5) < 0.05
        self.assertGreater(is_near[20:40, 58:72].sum(), (near == 0.5).sum())

    def test_moving_objects_are_left_out_or_wrong(self) -> None:
        frame = drives.frame()
        moving = np.zeros_like(frame.moving)
        moving[35:60] = True
        frame = replace(frame, moving=moving)
        for kept in (0, 1):
            points = simulate_stereo(
                frame, np.random.RandomState(3), replace(EXACT, moving_kept=kept)
            )
            known, error = relative_errors(points, frame.range)
            moves = moving[known]
            self.assertEqual(moves.any(), bool(kept))
            self.assertLess(np.median(np.abs(error[~moves])), 1e-3)
            if kept:
                self.assertGreater(np.median(np.abs(error[moves])), 0.02)

    def test_there_are_at_most_as_many_points_as_the_model_says(self) -> None:
        for grid in (0, 1):
            for seed in range(5):
                points = self.simulate(seed, points=(30_000, 30_000), grid=grid)
                count = (points.depth > 0).sum()
                # An image of 128 pixels has 1/64 of the points of one of 1024.
                self.assertTrue(150 < count < 30_000 / 64 * 1.2, count)

    def test_an_image_without_surfaces_or_contrast_gives_no_points(self) -> None:
        frame = drives.frame()
        for empty in (
            replace(frame, range=np.zeros_like(frame.range)),
            replace(frame, rgb=np.zeros_like(frame.rgb)),
        ):
            points = simulate_stereo(empty, np.random.RandomState(0), EXACT)
            self.assertLess((points.depth > 0).sum(), 20)
            self.assertTrue(np.isfinite(points.depth).all())
