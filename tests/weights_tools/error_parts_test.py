"""Parts of the error: masks against closed forms, and their sum against the whole."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import numpy as np
import torch

from tests.weights_tools import drives
from tests.weights_tools.evaluate_shards_test import knows
from weights_tools.evaluation import error_parts, evaluate_shards
from weights_tools.evaluation.given_points import points_of
from weights_tools.training import shards


class ErrorPartsTest(unittest.TestCase):
    def test_each_pixel_is_in_the_first_part_that_it_belongs_to(self) -> None:
        truth = torch.full((1, 1, 1, 40), 2.0)
        truth[..., 20:] = 2.6  # an edge between 19 and 20
        truth[..., 36:] = 0  # and one to the sky
        moving = torch.zeros(1, 1, 1, 40, dtype=torch.bool)
        moving[..., 19] = True
        depth = torch.zeros(1, 1, 1, 40)
        depth[..., 5] = 2.0
        parts = error_parts.parts_of(truth, moving, depth)
        columns = [set(torch.nonzero(part[0, 0, 0])[:, 0].tolist()) for part in parts]
        self.assertEqual(columns[0], {19})
        self.assertEqual(columns[1], {18, 20, 21, 34, 35, 36, 37})
        self.assertEqual(columns[2], set(range(1, 10)))
        self.assertEqual(columns[3], set(range(40)) - columns[0] - columns[1] - columns[2])

    def test_a_difference_of_less_than_a_quarter_is_no_edge(self) -> None:
        truth = torch.full((1, 1, 1, 10), 2.0)
        truth[..., 5:] = 2.4
        none = torch.zeros(1, 1, 1, 10, dtype=torch.bool)
        self.assertFalse(error_parts.parts_of(truth, none, torch.zeros(1, 1, 1, 10))[1].any())

    def test_parts_add_up_to_the_error_of_the_whole(self) -> None:
        frame = drives.frame()
        points = points_of(frame, "1000", 0)
        assert points is not None
        network = knows(1.1, 0.9)
        measured = error_parts.measure(network, frame, points)
        assert measured is not None
        self.assertAlmostEqual(measured[0].sum(), 1.0, places=5)
        self.assertAlmostEqual(measured[1].sum(), 0.1, places=5)
        whole = evaluate_shards.Errors()
        evaluate_shards.measure(network, frame, points, whole)
        self.assertAlmostEqual(whole.absrel[0], measured[1].sum(), places=5)
        self.assertTrue(np.all(measured[0][1:] > 0))

    def test_a_line_is_printed_for_each_part(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            shard = Path(folder) / "town1.npz"
            shards.write(shard, shards.pack([drives.frame()]))
            said = io.StringIO()
            arguments = ["error_parts", "network.h5", str(shard), "--points", "1000"]
            with (
                mock.patch.object(error_parts, "read_network", lambda _: knows(1.1, 0.9)),
                mock.patch.object(sys, "argv", arguments),
                contextlib.redirect_stdout(said),
            ):
                error_parts.main()
        lines = said.getvalue().splitlines()[2:]
        self.assertEqual(len(lines), len(error_parts.PARTS))
        self.assertRegex(lines[1], r"^\| towns \| 1000 \| edges \| 0\.\d+ \| 0\.100 \| 0\.\d+ \|$")


if __name__ == "__main__":
    unittest.main()
