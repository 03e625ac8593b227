"""The ground is the plane under the camera, and nothing else."""

import unittest

import numpy as np

from tests.weights_tools import drives
from weights_tools.training.ground import ground_pixels
from weights_tools.training.sphere import bearings

HEIGHT, WIDTH = 128, 256


def directions() -> np.ndarray:
    u, v = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    return bearings(u, v, HEIGHT, WIDTH)


def ranges_to_plane(normal: np.ndarray, distance: float) -> np.ndarray:
    """0 beyond 60 m and above."""
    away = -directions() @ normal
    ranges = distance / np.where(away > 1e-6, away, 1e-6)
    return np.where((away > 1e-6) & (ranges < 60), ranges, 0)


class GroundTest(unittest.TestCase):
    def test_the_road_is_ground_and_walls_are_not(self) -> None:
        up = np.array([0.0, 0.0, 1.0])
        found = ground_pixels(drives.street(), up, drives.CAMERA_HEIGHT)
        expected = drives.road()
        self.assertTrue(found[expected].all())
        # A wall is within reach of the tolerance along its foot only.
        self.assertLess((found & ~expected).sum(), 0.02 * expected.sum())

    def test_a_tilted_camera_over_a_slope_finds_it(self) -> None:
        up = np.array([0.08, -0.05, 1.0])
        up /= np.linalg.norm(up)
        slope = up + [0.05, 0.02, 0.0]
        slope /= np.linalg.norm(slope)
        height = 2.0
        # The camera stands `height` above the road, measured along the vertical.
        ranges = ranges_to_plane(slope, height * float(slope @ up))
        found = ground_pixels(ranges, up, height)
        self.assertGreater(found[ranges > 0].mean(), 0.99)

    def test_kerbs_and_roofs_are_none(self) -> None:
        up = np.array([0.0, 0.0, 1.0])
        road, kerb, roof = (ranges_to_plane(up, height) for height in (1.8, 1.68, 0.4))
        right = directions()[..., 1] * road  # metres
        away = np.hypot(*np.moveaxis(directions()[..., :2] * road[..., None], -1, 0))
        pavement = (right > 4) & (away < 12) & (road > 0)
        ranges = np.where(pavement, kerb, road)
        car = (right < -3) & (away > 6) & (away < 12)
        ranges = np.where(car, roof, ranges)
        found = ground_pixels(ranges, up, 1.8)
        near = (away < 12) & (road > 0)
        self.assertFalse(found[car].any())
        # Rays that meet the pavement; those on its edge fall down to the road.
        self.assertLess(found[pavement].mean(), 0.02)
        self.assertGreater(found[near & ~pavement & ~car].mean(), 0.99)

    def test_there_is_none_in_the_sky_or_at_another_height(self) -> None:
        up = np.array([0.0, 0.0, 1.0])
        self.assertFalse(ground_pixels(np.zeros((HEIGHT, WIDTH)), up, 1.5).any())
        self.assertFalse(ground_pixels(ranges_to_plane(up, 4.0), up, 1.5).any())


if __name__ == "__main__":
    unittest.main()
