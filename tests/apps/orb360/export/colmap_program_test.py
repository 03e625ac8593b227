"""Debian's colmap opens an exported rig, triangulates it again from features of its own, and
undistorts its images."""

import re
import shutil
import subprocess
import sys
import unittest
from pathlib import Path

import colmap_reader
import numpy as np
from rendered_run import RenderedRun


def colmap(command: str, *options: object) -> str:
    done = subprocess.run(["colmap", command, *map(str, options)], check=False, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0:
        raise AssertionError(f"colmap {command}: {done.stdout[-2000:]}")
    return done.stdout


class ColmapProgram(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.run_ = RenderedRun(24, 1024)
        cls.folder = cls.run_.export("colmap-rig")
        cls.sparse = cls.folder / "sparse" / "0"

    @classmethod
    def tearDownClass(cls) -> None:
        cls.run_.temporary.cleanup()

    def test_model_analyzer_agrees_with_the_files(self) -> None:
        text = colmap("model_analyzer", "--path", self.sparse)
        model = colmap_reader.read_binary(self.sparse)
        for name, number in (("Cameras", 6), ("Registered images", len(model.images)),
                             ("Points", len(model.points))):
            self.assertIn(f"{name}: {number}\n", text)
        error = float(re.search(r"Mean reprojection error: ([\d.]+)px", text).group(1))
        self.assertLess(error, 1.0)
        self.assertAlmostEqual(error, np.mean([p[2] for p in model.points.values()]), delta=0.1)

    def test_point_triangulator_finds_points_that_fit_the_poses(self) -> None:
        # Few frames, because COLMAP's features take their time without a GPU. It wants all images of
        # the model in its database, and finds them there by name.
        folder = self.run_.export("colmap-rig", "--frames", "sharpest", "--spacing", 0.4,
                                  name="few")
        database, images = self.run_.folder / "db.db", folder / "images"
        colmap("feature_extractor", "--database_path", database, "--image_path", images,
               "--ImageReader.single_camera_per_folder", 1, "--ImageReader.camera_model", "PINHOLE",
               "--SiftExtraction.use_gpu", 0, "--SiftExtraction.max_num_features", 600)
        colmap("sequential_matcher", "--database_path", database, "--SiftMatching.use_gpu", 0,
               "--SequentialMatching.overlap", 3, "--SequentialMatching.quadratic_overlap", 0)
        out = self.run_.folder / "triangulated"
        out.mkdir()
        colmap("point_triangulator", "--database_path", database, "--image_path", images,
               "--input_path", folder / "sparse" / "0", "--output_path", out, "--clear_points", 1)
        text = colmap("model_analyzer", "--path", out)
        error = float(re.search(r"Mean reprojection error: ([\d.]+)px", text).group(1))
        self.assertLess(error, 1.0)
        self.assertGreater(int(re.search(r"Points: (\d+)", text).group(1)), 100)

    def test_image_undistorter_writes_every_image(self) -> None:
        out = self.run_.folder / "undistorted"
        colmap("image_undistorter", "--image_path", self.folder / "images", "--input_path",
               self.sparse, "--output_path", out, "--output_type", "COLMAP")
        count = len(list((out / "images").rglob("*.jpg")))
        self.assertEqual(count, len(colmap_reader.read_binary(self.sparse).images))
        self.assertTrue((out / "sparse" / "cameras.bin").exists())


if __name__ == "__main__":
    if shutil.which("colmap") is None:
        print("skipped: there is no colmap; install Debian's package colmap")
        sys.exit(77)
    unittest.main()
