"""The examples, built against an installed prefix, do what they say on a rendered drive."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import cv2
import numpy as np

PACKAGE = Path(os.environ["ORB360_PACKAGE"])
FRAMES = 60


def run(program: Path, *arguments: object, fails: bool = False) -> str:
    done = subprocess.run([str(program), *map(str, arguments)], check=False, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if (done.returncode != 0) != fails:
        raise AssertionError(f"{program.name} ended with {done.returncode}: {done.stdout[-1000:]}")
    return done.stdout


def depth(path: Path) -> np.ndarray:
    """Metres, by the file format of depth images; 0 for none."""
    return cv2.imread(str(path), cv2.IMREAD_UNCHANGED).astype(float) / 256


class Examples(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.temporary = tempfile.TemporaryDirectory(dir=PACKAGE)
        cls.folder = Path(cls.temporary.name)
        cls.town = cls.folder / "town"
        run(PACKAGE / "bin/town", "render", "--town", 7, "--frames", FRAMES, "--width", 512,
            "--depth-every", 10, "--out", cls.town)

    @classmethod
    def tearDownClass(cls) -> None:
        cls.temporary.cleanup()

    def test_track_writes_the_true_trajectory(self) -> None:
        trajectory = self.folder / "trajectory.txt"
        run(PACKAGE / "examples/track", self.town, trajectory)
        estimate, truth = np.loadtxt(trajectory), np.loadtxt(self.town / "groundtruth.txt")
        self.assertGreater(len(estimate), 0.9 * FRAMES)

        def length(poses: np.ndarray) -> float:
            return float(np.linalg.norm(poses[-1, 1:4] - poses[0, 1:4]))

        seen = np.searchsorted(truth[:, 0], estimate[:, 0] - 1e-3)
        self.assertAlmostEqual(length(estimate) / length(truth[seen]), 1.0, delta=0.05)

    def test_complete_is_near_the_true_depth(self) -> None:
        true = depth(self.town / "depth/000020.png")
        sparse = np.where(np.random.default_rng(1).random(true.shape) < 0.01, true, 0)
        points = self.folder / "sparse.png"
        cv2.imwrite(str(points), np.round(256 * sparse).astype(np.uint16))
        run(PACKAGE / "examples/complete", self.town / "rgb/000020.jpg", points,
            self.folder / "dense.png")
        dense = depth(self.folder / "dense.png")
        known = (true > 0) & (dense > 0)
        self.assertGreater(known.sum(), 0.9 * (true > 0).sum())
        error = np.median(np.abs(dense[known] - true[known]) / true[known])
        self.assertLess(error, 0.1)

    def test_dense_cloud_writes_a_cloud(self) -> None:
        cloud = self.folder / "cloud.ply"
        printed = run(PACKAGE / "examples/dense_cloud", self.town, cloud)
        points = int(printed.split()[0])
        self.assertGreater(points, 10_000)
        self.assertIn(f"element vertex {points}".encode(), cloud.read_bytes()[:1000])

    def test_a_missing_input_is_told_in_one_line(self) -> None:
        printed = run(PACKAGE / "examples/track", self.folder / "none", "x", fails=True)
        self.assertEqual(printed.count("\n"), 1)
        self.assertIn("no such file or folder", printed)


if __name__ == "__main__":
    unittest.main()
