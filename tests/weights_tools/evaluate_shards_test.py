"""Errors of a network on shards are those of closed forms, by kind of world and of points."""

import contextlib
import io
import sys
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np
import torch

from tests.weights_tools import drives
from weights_tools import networks
from weights_tools.evaluation import evaluate_shards, given_points
from weights_tools.export import export
from weights_tools.network import Network
from weights_tools.training import batches, shards, train


def knows(factor: float, confidence: float) -> evaluate_shards.Completes:
    """A network that states the street's range times a factor, with that confidence."""

    def complete(inputs: dict[str, torch.Tensor]) -> dict[str, torch.Tensor]:
        truth = torch.from_numpy(np.maximum(drives.street(), 1e-3))[None, None]
        return {
            "scale": torch.ones(1, 1, 1, 1),
            "log_depth": (factor * truth).log(),
            "confidence": torch.full_like(truth, confidence),
            "ground": torch.zeros_like(truth),
        }

    return complete


class EvaluateShardsTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)
        rows, columns = np.nonzero(drives.street()[::8, ::8])
        at = 8 * rows, 8 * columns
        points = np.stack([*at, 1.1 * drives.street()[at], np.ones(len(rows))], axis=1)
        self.points = len(points)
        tracked = replace(drives.frame(), points=points.astype(np.float32))
        for name, frames in (("town3", [drives.frame()]), ("kart-hill", [drives.frame(), tracked])):
            shards.write(self.folder / f"{name}.npz", shards.pack(frames))

    def measured(self, network: evaluate_shards.Completes, *kinds: str) -> dict[tuple[str, str], list[str]]:
        paths = sorted(self.folder.glob("*.npz"))
        results = evaluate_shards.evaluate(network, paths, kinds, 1)
        return {(world, kind): errors.row() for world, kind, errors in results}

    def test_a_constant_factor_is_the_relative_error(self) -> None:
        rows = self.measured(knows(1.2, 1 / 1.1), "300", "100000")
        self.assertEqual(set(rows), {(w, k) for w in ("towns", "karts") for k in ("300", "100000")})
        for _, absrel, delta1, _, ratio in rows.values():
            self.assertEqual((absrel, delta1), ("0.200", "1.000"))
            self.assertEqual(ratio, "2.00 to 2.00")  # it states an error of 0.1
        given = [int(rows["towns", kind][0]) for kind in ("300", "100000")]
        self.assertTrue(100 < given[0] <= 300 < given[1] < 100_000 / 64 * 1.2)
        (_, absrel, delta1, _, _) = self.measured(knows(1.3, 0.5), "300")["towns", "300"]
        self.assertEqual((absrel, delta1), ("0.300", "0.000"))

    def test_points_of_slam_are_used_where_there_are_any(self) -> None:
        rows = self.measured(knows(1, 0.9), given_points.SLAM)
        self.assertEqual(list(rows), [("karts", "slam")])
        count, _, _, error, _ = rows["karts", "slam"]
        self.assertEqual((int(count), error), (self.points, "0.100"))

    def test_without_a_tensor_a_file_and_a_checkpoint_see_zeros_in_its_place(self) -> None:
        settings = train.Settings(network="coarse_depth_completion", steps=1, batch=1, warm_up=1)
        paths = [self.folder / "town3.npz"]
        with contextlib.redirect_stdout(io.StringIO()):
            trained = train.train(settings, self.folder / "out", paths, [], torch.device("cpu"))
        export(self.folder / "network.h5", trained, {})
        seen = batches.collate([batches.plain(drives.frame(), given_points.points_of(drives.frame(), "300", 0))])
        dark = {**seen.inputs, "image": torch.zeros_like(seen.inputs["image"])}
        with torch.no_grad():
            for path in (self.folder / "out/checkpoint.pt", self.folder / "network.h5"):
                whole, blind = (evaluate_shards.read_network(path, names) for names in ((), ["image"]))
                expected = whole(dark)["log_depth"]
                self.assertTrue(torch.equal(blind(seen.inputs)["log_depth"], expected))
                self.assertFalse(torch.equal(whole(seen.inputs)["log_depth"], expected))
                with self.assertRaisesRegex(ValueError, 'has no tensor "imaeg"'):
                    evaluate_shards.read_network(path, ["imaeg"])

    def test_prints_a_row_for_each_world_and_kind(self) -> None:
        network = self.folder / "network.h5"
        export(network, Network(networks.propagation()), {})
        shards_of = [str(path) for path in sorted(self.folder.glob("*.npz"))]
        words = ["evaluate_shards", str(network), *shards_of, "--points", "300", "slam"]
        with mock.patch.object(sys, "argv", words):
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                evaluate_shards.main()
        rows = printed.getvalue().splitlines()[2:]
        self.assertEqual([row.split(" | ")[0:2] for row in rows],
                         [["| karts", "300"], ["| karts", "slam"], ["| towns", "300"]])  # fmt: skip


if __name__ == "__main__":
    unittest.main()
