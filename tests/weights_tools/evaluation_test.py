"""Measures are what they say, on images whose errors are known."""

import contextlib
import io
import json
import stat
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

import cv2
import h5py
import numpy as np

from tests.weights_tools import drives
from weights_tools import network_file, networks
from weights_tools.evaluation import evaluate_depth, evaluated_drives, results, tables, visualization
from weights_tools.evaluation.depth_errors import DepthErrors
from weights_tools.export import export, untrained
from weights_tools.network import Network
from weights_tools.training.sparse_points import simulate
from weights_tools.training.train import Settings


class DepthErrorsTest(unittest.TestCase):
    def test_measures_of_a_constant_factor(self) -> None:
        truth = np.full((60, 120), 8.0)
        errors = DepthErrors()
        errors.add(truth, 1.1 * truth)
        for where in ({}, {"range_bin": 1}, {"band": 0}, {"band": 5}):
            measures = errors.measures(**where)
            self.assertAlmostEqual(measures["absrel"], 0.1)
            self.assertAlmostEqual(measures["rmse"], 0.8)
            self.assertAlmostEqual(measures["mae"], 0.8)
            self.assertAlmostEqual(measures["delta1"], 1.0)
            self.assertAlmostEqual(measures["imae"], 1000 / 8 - 1000 / 8.8)
            self.assertAlmostEqual(measures["irmse"], 1000 / 8 - 1000 / 8.8)
        self.assertTrue(np.isnan(errors.measures(range_bin=0)["absrel"]))

    def test_pixels_count_by_solid_angle_bin_and_band(self) -> None:
        truth = np.full((90, 180), 30.0)
        truth[:45] = 100.0  # too far to count
        truth[45:, :90] = 3.0
        estimate = truth.copy()
        estimate[75:] *= 2  # the lowest band: 1 - sin(60 degrees) of the lower half
        errors = DepthErrors()
        errors.add(truth, estimate)
        self.assertAlmostEqual(errors.measures()["absrel"], 1 - np.sin(np.pi / 3), places=3)
        self.assertAlmostEqual(errors.measures(band=0)["absrel"], 1.0)
        self.assertEqual(errors.measures(band=1)["absrel"], 0.0)
        self.assertTrue(np.isnan(errors.measures(band=3)["absrel"]))
        # Errors of both ranges count equally: RMSE tells them apart.
        near, far = errors.measures(range_bin=0)["rmse"], errors.measures(range_bin=3)["rmse"]
        self.assertAlmostEqual(far / near, 10)
        twice = DepthErrors()
        twice += errors
        twice += errors
        self.assertAlmostEqual(twice.measures()["rmse"], errors.measures()["rmse"])

    def test_delta_counts_both_directions(self) -> None:
        truth = np.full((6, 12), 10.0)
        for factor, expected in ((1.24, 1), (1.26, 0), (1 / 1.24, 1), (1 / 1.26, 0)):
            errors = DepthErrors()
            errors.add(truth, factor * truth)
            self.assertEqual(errors.measures()["delta1"], expected)


class EvaluationTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def program(self, factor: float) -> Path:
        """Stands for orb360: knows the street, but for a factor."""
        street = np.rint(256 * factor * drives.street()).astype(np.uint16)
        # Where there is sky some depth is claimed, with little confidence.
        cv2.imwrite(str(self.folder / "street.png"), np.where(street == 0, 30000, street))
        sure = np.where(drives.street() > 0, 60000, 20000).astype(np.uint16)
        cv2.imwrite(str(self.folder / "sure.png"), sure)
        path = self.folder / "orb360"
        path.write_text(
            f"""#!/usr/bin/python3
import json, pathlib, sys
options = dict(zip(sys.argv[2::2], sys.argv[3::2]))
assert sys.argv[1] == "complete" and sys.argv[-1] == "--json"
assert pathlib.Path(options["--weights"]).exists()
here = {str(self.folder)!r}
print(json.dumps([dict(sparse=str(f), depth=here + "/street.png", confidence=here + "/sure.png",
    camera_height={drives.CAMERA_HEIGHT / 1.2}, camera_height_guess={drives.CAMERA_HEIGHT / 1.1})
    for f in sorted(pathlib.Path(options["--sparse"]).glob("*.h5"))]))
"""
        )
        path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return path

    def test_the_summary_is_of_what_the_program_gave(self) -> None:
        weights = self.folder / "net.h5"
        network, provenance = untrained("propagation", 0)
        export(weights, network, provenance)
        methods = {results.OURS: weights, results.ALONE: weights}
        evaluation = evaluate_depth.Evaluation(
            methods, self.program(1.2), ("100", "1000", "100000", "slam"), shown=1, out=self.folder
        )
        result = evaluation.drive("street", [drives.frame(0), drives.frame(1)])
        summary = result.summary()
        self.assertAlmostEqual(summary["absrel"], 0.2, delta=0.002)
        self.assertEqual(summary["delta1"], 1)
        self.assertAlmostEqual(summary["absrel_propagation"], 0.2, delta=0.002)
        self.assertTrue(np.isnan(summary["absrel_published"]))
        self.assertTrue(0.02 < summary["absrel_best_classical"] < 0.3)
        for key in ("median_abs_log", "p95_abs_log", "fused_median_abs_log"):
            self.assertAlmostEqual(summary[f"scale_{key}"], np.log(1.2), delta=0.005)
        self.assertAlmostEqual(summary["scale_guard_median_abs_log"], np.log(1.1), places=6)
        total = results.Result()
        total += result
        self.assertEqual(total.summary()["absrel"], summary["absrel"])
        table = results.calibration_table(total)
        np.testing.assert_allclose(table[:, 1], 0.2, atol=0.01)
        np.testing.assert_allclose(table[:, 0], 65535 / 60000 - 1, atol=1e-4)
        visualization.write_calibration(self.folder / "calibration.png", table)
        for name in ("street-0.jpg", "calibration.png"):
            self.assertIsNotNone(cv2.imread(str(self.folder / name)), name)
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            tables.print_tables({"street": result}, total)
        self.assertRegex(printed.getvalue(), r"street \| 0\.200 \| 1\.000")
        # By world and number of points; the frames have none of SLAM.
        heads = "|  | 100 points | 1000 points | 100000 points |"
        self.assertIn(heads, printed.getvalue())
        row = r"\| street( \| 0\.200 / 0\.\d\d\d, 1\.000){3} \|"
        self.assertRegex(printed.getvalue(), row)

    def test_a_completed_range_that_the_image_cannot_store_is_far_away(self) -> None:
        path = str(self.folder / "depth.png")
        cv2.imwrite(path, np.array([[0, 256, 65535]], np.uint16))
        np.testing.assert_allclose(evaluate_depth.read_depth(path), [[256, 1, 256]], rtol=1e-4)

    def test_sparse_files_have_what_the_program_reads(self) -> None:
        frame = drives.frame()
        points = simulate(frame, np.random.RandomState(0))
        evaluate_depth.write_sparse(self.folder / "a.h5", frame, points)
        with h5py.File(self.folder / "a.h5") as file:
            np.testing.assert_array_equal(file["image"], frame.rgb)
            np.testing.assert_array_equal(file["range"], points.depth)
            self.assertEqual(file["confidence"].dtype, np.float32)
            self.assertEqual(file.attrs["world_from_camera"].shape, (7,))

    def test_propagation_is_taken_out_of_a_network(self) -> None:
        description = networks.depth_completion((8, 12, 20, 24, 36), hidden=10)
        path = self.folder / "whole.h5"
        export(path, Network(description), {})
        alone = evaluate_depth.propagation_of(path, self.folder / "alone.h5")
        outputs = [port["tensor"] for port in network_file.read(alone).graph.outputs]
        self.assertEqual(outputs, ["alone.log_depth", "alone.confidence", "points.median"])

    def test_evaluation_towns_are_rendered_with_all_mountings(self) -> None:
        specs = evaluated_drives.town_specs("Town1", is_quick=True)
        self.assertEqual(sum(spec.frames // evaluated_drives.QUICK_EVERY for spec in specs), 20)
        self.assertEqual(len({spec.name for spec in specs}), 3)
        text = json.dumps([list(spec.options) for spec in specs])
        for part in ('"--camera-height", "1.0"', '"--camera-pitch", "5"', '"--depth-every", "5"'):
            self.assertIn(part, text)
        self.assertEqual(Settings().network, "depth_completion")

    def test_risk_grows_with_coverage_as_the_confident_are_right(self) -> None:
        expected = np.repeat([0.1, 0.2, 0.4], [50, 30, 20])
        drawn = np.stack([expected, 2 * expected, np.ones(100)])
        result = results.Result(calibration=[drawn[:, ::-1]])
        curve = results.risk_coverage(result)
        np.testing.assert_allclose(curve[:, 0], np.arange(1, 11) / 10)
        np.testing.assert_allclose(curve[:5, 1], 0.2)
        self.assertAlmostEqual(curve[7, 1], (50 * 0.2 + 30 * 0.4) / 80)
        self.assertAlmostEqual(curve[9, 1], (50 * 0.2 + 30 * 0.4 + 20 * 0.8) / 100)

    def folder_of_images(self) -> Path:
        folder = self.folder / "room"
        for name in ("rgb", "depth"):
            (folder / name).mkdir(parents=True)
        image = drives.frame().rgb
        cv2.imwrite(str(folder / "rgb/000002.png"), image[:, :, ::-1])
        cv2.imwrite(str(folder / "rgb/000003.png"), image)  # has no depth and is left out
        depth = np.rint(256 * drives.street()).astype(np.uint16)
        cv2.imwrite(str(folder / "depth/000002.png"), depth)
        return folder

    def test_a_folder_of_images_with_depth_is_read_with_the_points_of_its_run(self) -> None:
        folder = self.folder_of_images()
        (frame,) = evaluated_drives.folder_frames(folder)
        np.testing.assert_array_equal(frame.rgb, drives.frame().rgb)
        np.testing.assert_allclose(frame.range, drives.street(), atol=1 / 512)
        self.assertEqual(len(frame.points), 0)
        self.assertGreater(len(frame.features), 10)
        drives.write_run(folder)
        (frame,) = evaluated_drives.folder_frames(folder)
        rows, columns = frame.points[:, :2].astype(int).T
        np.testing.assert_allclose(frame.points[:, 2], frame.range[rows, columns], rtol=0.01)

    def test_a_folder_that_is_none_is_refused_with_the_reason(self) -> None:
        folder = self.folder_of_images()
        for name, complaint in (("rgb/000002.png", "has no image of its name"),
                                ("depth/000002.png", "metres = value / 256")):  # fmt: skip
            content = (folder / name).read_bytes()
            (folder / name).unlink()
            with self.assertRaisesRegex(ValueError, complaint):
                evaluated_drives.folder_frames(folder)
            (folder / name).write_bytes(content)
        cv2.imwrite(str(folder / "depth/000002.png"), np.zeros((64, 128), np.uint8))
        with self.assertRaisesRegex(ValueError, "one channel of 16 bits"):
            evaluated_drives.folder_frames(folder)
        cv2.imwrite(str(folder / "depth/000002.png"), np.zeros((32, 64), np.uint16))
        with self.assertRaisesRegex(ValueError, "another size"):
            evaluated_drives.folder_frames(folder)

    def test_unknown_towns_and_missing_files_are_refused_before_anything_is_rendered(self) -> None:
        script = evaluate_depth.ROOT / "scripts/evaluate-depth"
        for arguments, complaint in (
            (["Town6"], "unknown town 'Town6': use Town1"),
            (["--towns", "Town1", "Twon2"], "unknown town 'Twon2'"),
            (["--circuits", "absent.acc"], "absent.acc: no such file"),
            (["--shards", "absent.npz"], "absent.npz: no such file"),
            (["--published", "absent.h5"], "absent.h5: no such file"),
            (["--folder", "absent"], "absent: no such folder"),
            (["--points", "many"], "'many' is neither a number of points nor 'slam'"),
        ):
            command = [sys.executable, script, "--skip-build", *arguments]
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertNotEqual(done.returncode, 0)
            self.assertIn(complaint, done.stderr)


if __name__ == "__main__":
    unittest.main()
