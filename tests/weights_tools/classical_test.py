"""Interpolation reproduces what each method reproduces by its definition."""

import unittest

import numpy as np

from tests.weights_tools import drives
from weights_tools.evaluation import classical
from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import SparsePoints
from weights_tools.training.sphere import bearings

HEIGHT, WIDTH = 64, 128


def points(ranges: dict[tuple[int, int], float], confidence: float = 1.0) -> SparsePoints:
    depth = np.zeros((HEIGHT, WIDTH), np.float32)
    for at, value in ranges.items():
        depth[at] = value
    return SparsePoints(depth, np.where(depth > 0, np.float32(confidence), 0), 1.0)


def frame(rgb: np.ndarray | None = None) -> Frame:
    given = drives.frame()
    return given if rgb is None else Frame(rgb, *list(vars(given).values())[1:])


class ClassicalTest(unittest.TestCase):
    def test_the_nearest_point_across_the_seam_and_the_pole(self) -> None:
        given = points({(36, 124): 5.0, (36, 60): 9.0})
        nearest = classical.nearest_neighbour(frame(), given)
        self.assertEqual(nearest.shape, (HEIGHT // classical.STEP, WIDTH // classical.STEP))
        self.assertEqual(nearest[4, 0], 5.0)  # pixel 36, 4
        self.assertEqual(nearest[0, 15], 5.0)
        self.assertEqual(nearest[4, 8], 9.0)

    def test_inverse_distance_weighs_by_confidence_and_squared_angle(self) -> None:
        given = points({(36, 60): 4.0, (36, 76): 8.0})
        given.confidence[36, 76] = 0.4
        weighted = classical.inverse_distance(frame(), given)[4, 8]  # pixel 36, 68
        self.assertAlmostEqual(float(weighted), (4 + 0.4 * 8) / 1.4, places=3)

    def test_natural_neighbours_reproduce_a_plane_between_points_all_around(self) -> None:
        rows, columns = np.mgrid[0:256, 0:512]
        seen = bearings(columns + 0.5, rows + 0.5, 256, 512)
        plane = 1 / (0.2 - 0.15 * seen[..., 2])  # inverse ranges are linear in directions
        depth = np.zeros(plane.shape, np.float32)
        at = np.random.RandomState(0).permutation(plane.size)[:1000]
        depth.flat[at] = plane.flat[at]
        given = SparsePoints(depth, (depth > 0).astype(np.float32), 1.0)
        truth = classical.thinned(plane)
        natural = classical.natural_neighbour(frame(), given)
        nearest = classical.nearest_neighbour(frame(), given)
        error, worse = (np.abs(found / truth - 1).mean() for found in (natural, nearest))
        self.assertLess(error, 0.006)
        self.assertLess(error, 0.25 * worse)

    def test_natural_neighbours_keep_the_points(self) -> None:
        given = points({(36, 60): 4.0, (20, 100): 8.0, (52, 12): 2.0})
        natural = classical.natural_neighbour(frame(), given)
        for row, column in ((36, 60), (20, 100), (52, 12)):
            found = natural[row // classical.STEP, column // classical.STEP]
            self.assertAlmostEqual(float(found), float(given.depth[row, column]), places=5)

    def test_the_guided_filter_smooths_between_edges_and_keeps_them(self) -> None:
        edge = np.zeros((HEIGHT, WIDTH, 3), np.uint8)
        edge[:, 32:96] = 255
        random = np.random.RandomState(1)
        spots = {}
        for i in random.permutation(HEIGHT * WIDTH)[:800]:
            row, column = divmod(int(i), WIDTH)
            inside = 32 <= column < 96
            spots[row, column] = (4.0 if inside else 8.0) * float(np.exp(0.1 * random.randn()))
        given = points(spots)
        columns = np.arange(classical.STEP // 2, WIDTH, classical.STEP)
        truth = np.where((columns >= 32) & (columns < 96), 4.0, 8.0)

        def error(found: np.ndarray) -> float:
            return float(np.abs(np.log(found / truth))[2:-2].mean())

        guided = error(classical.guided_filter(frame(edge), given))
        self.assertLess(guided, 0.6 * error(classical.nearest_neighbour(frame(edge), given)))
        blind = classical.guided_filter(frame(np.zeros_like(edge)), given)
        self.assertLess(guided, 0.6 * error(blind))

    def test_without_points_it_is_the_unit(self) -> None:
        for name, method in classical.METHODS.items():
            self.assertTrue((method(frame(), points({})) == 1).all(), name)

    def test_a_single_point_is_everywhere(self) -> None:
        for name, method in classical.METHODS.items():
            estimate = method(frame(), points({(10, 10): 3.0}))
            np.testing.assert_allclose(estimate, 3, rtol=1e-4, err_msg=name)


if __name__ == "__main__":
    unittest.main()
