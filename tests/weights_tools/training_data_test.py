"""Samples made of drives contain what SLAM would know and nothing else."""

import tempfile
import unittest
from dataclasses import fields, replace
from pathlib import Path

import cv2
import h5py
import numpy as np

from tests.weights_tools import drives
from weights_tools.training import batches, compare_points, make_shard, shards
from weights_tools.training.sparse_points import NoiseModel, from_slam, simulate
from weights_tools.training.sphere import bearings, row_weights

EXACT = NoiseModel(
    from_stereo=0,
    thinned=0,
    baseline=(1e6, 1e6),
    noise=(1, 1),
    estimate_error=0,
    outliers=0,
    edge_outliers=0,
    points=(1000, 1000),
)


class SphereTest(unittest.TestCase):
    def test_axes_are_those_of_the_camera(self) -> None:
        forward, right, up = (-1, 0, 0), (0, 1, 0), (0, 0, 1)
        for (u, v), expected in (((50, 25), forward), ((75, 25), right), ((50, 0), up)):
            bearing = bearings(np.array(u), np.array(v), 50, 100)
            np.testing.assert_allclose(bearing, expected, atol=1e-15)
        seam = bearings(np.array([0.0, 100.0]), np.array([25.0, 25.0]), 50, 100)
        np.testing.assert_allclose(seam[0], seam[1], atol=1e-15)

    def test_row_weights_are_solid_angles(self) -> None:
        weights = row_weights(90)
        self.assertAlmostEqual(weights.mean(), 1)
        bands = np.sin(np.radians(np.arange(90, -92, -2)))  # between rows
        np.testing.assert_allclose(weights, (bands[:-1] - bands[1:]) * 45, rtol=1e-3)


class ShardTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def test_frames_survive_packing(self) -> None:
        moving = np.zeros((drives.HEIGHT, drives.WIDTH), bool)
        moving[3, 5:9] = True
        first = replace(drives.frame(0), moving=moving)
        second = drives.frame(1)
        points = np.array([[1, 2, 3.5, 0.25], [4, 5, 6.5, 1]], np.float32)
        second = replace(second, features=second.features[:7], camera_height=2.0, points=points)
        path = self.folder / "shard.npz"
        shards.write(path, shards.pack([first, second]))
        shard = shards.read(path)
        self.assertEqual(len(shard), 2)
        for i, expected in enumerate((first, second)):
            frame = shard.frame(i)
            for field in fields(frame):
                values = getattr(frame, field.name)
                tolerance = 0.5 / 256 + 1e-6 if field.name == "range" else 0
                np.testing.assert_allclose(values, getattr(expected, field.name), atol=tolerance)

    def test_refuses_other_files(self) -> None:
        path = self.folder / "other.npz"
        np.savez(path, rgb=np.zeros(1))
        with self.assertRaisesRegex(ValueError, "is no shard of frames: it lacks"):
            shards.read(path)

    def test_a_drive_is_read_as_it_was_rendered(self) -> None:
        drives.write_drive(self.folder)
        frames = make_shard.read_drive(self.folder)
        self.assertEqual(len(frames), 2)  # the second frame has no depth
        for frame in frames:
            np.testing.assert_allclose(frame.range, drives.street(), atol=0.5 / 256)
            self.assertEqual(frame.camera_height, drives.CAMERA_HEIGHT)
            self.assertEqual(frame.moving.sum(), 8 * 28)
            self.assertTrue(frame.moving[40, 127])
            # It drives to its own right.
            np.testing.assert_allclose(frame.travel, [0, 1, 0], atol=1e-6)
        image = cv2.imread(str(self.folder / "rgb/000000.jpg"))
        np.testing.assert_array_equal(frames[0].rgb, image[:, :, ::-1])

    def test_the_height_is_measured_where_the_drive_states_none(self) -> None:
        drives.write_drive(self.folder)
        (self.folder / "sequence.yaml").write_text("fps: 10\n")
        for frame in make_shard.read_drive(self.folder):
            self.assertAlmostEqual(frame.camera_height, drives.CAMERA_HEIGHT, delta=0.01)
            self.assertGreater(frame.ground.mean(), 0.3)
        for path in (self.folder / "depth").iterdir():  # nothing below the camera
            metres = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
            metres[drives.HEIGHT // 2 :] = 0
            cv2.imwrite(str(path), metres)
        with self.assertRaisesRegex(ValueError, "has no depth"):
            make_shard.read_drive(self.folder)

    def test_points_of_slam_are_kept_in_metres(self) -> None:
        drives.write_drive(self.folder)
        drives.write_run(self.folder / "run")
        for halvings in (0, 1):
            first, second = make_shard.read_drive(self.folder, halvings, self.folder / "run")
            self.assertEqual(len(first.points), 0)
            rows, columns, metres, confidence = second.points.T
            self.assertEqual(len(rows), (drives.street()[::8, ::8] > 0).sum())
            at = (rows * 2**halvings).astype(int), (columns * 2**halvings).astype(int)
            truth = drives.street()[at]
            np.testing.assert_allclose(metres, truth, rtol=2e-3)
            self.assertTrue((confidence == 0.75).all())
            points = from_slam(second, np.random.RandomState(0), EXACT)
            known = points.depth > 0
            self.assertEqual(known.sum(), len(rows))
            measured = points.depth[known] / points.scale
            np.testing.assert_allclose(np.sort(measured), np.sort(metres), rtol=1e-5)

    def test_refuses_runs_without_sparse_depth_or_of_another_size(self) -> None:
        drives.write_drive(self.folder)
        with self.assertRaisesRegex(ValueError, "has no sparse depth; run orb360 with --save"):
            make_shard.read_drive(self.folder, run=self.folder)
        drives.write_run(self.folder / "run")
        with h5py.File(self.folder / "run/sparse/000002.h5", "a") as file:
            del file["range"]
            file["range"] = np.zeros((8, 16), np.float32)
        with self.assertRaisesRegex(ValueError, "000002.h5: has another size than the drive"):
            make_shard.read_drive(self.folder, run=self.folder / "run")

    def test_halving_keeps_ranges_that_exist(self) -> None:
        drives.write_drive(self.folder)
        (frame, _), street = make_shard.read_drive(self.folder, 1), drives.street()
        self.assertEqual(frame.range.shape, (32, 64))
        self.assertEqual(frame.rgb.shape, (32, 64, 3))
        for v, u in np.ndindex(32, 64):
            square = np.sort(street[2 * v : 2 * v + 2, 2 * u : 2 * u + 2], axis=None)
            square[square == 0] = np.inf
            expected = np.sort(square)[1]
            expected = 0 if np.isinf(expected) else expected
            self.assertAlmostEqual(frame.range[v, u], expected, delta=0.5 / 256 + 1e-6)

    def test_refuses_drives_without_depth_or_masks(self) -> None:
        drives.write_drive(self.folder)
        (self.folder / "moving/000002.png").unlink()
        with self.assertRaisesRegex(ValueError, "000002.png: cannot be read; render the drive"):
            make_shard.read_drive(self.folder)
        for path in (self.folder / "depth").iterdir():
            path.unlink()
        with self.assertRaisesRegex(ValueError, "has no depth; render it with"):
            make_shard.read_drive(self.folder)

    def test_features_are_found_on_both_sides_of_the_seam_once(self) -> None:
        noise = np.random.RandomState(0).randint(0, 256, (60, 80)).astype(np.uint8)
        image = np.full((256, 512, 3), 128, np.uint8)
        blurred = cv2.normalize(cv2.GaussianBlur(noise, (0, 0), 2), None, 0, 255, cv2.NORM_MINMAX)
        image[100:160, 180:260] = blurred[:, :, None]
        moved = np.roll(image, 512 - 220, axis=1)  # the texture is cut in two
        expected, found = make_shard.detect(image), make_shard.detect(moved)
        # Coarser levels are sampled at other places; about as many corners are found there.
        self.assertAlmostEqual(len(found) / len(expected), 1, delta=0.2)
        expected, found = (f[f[:, 2] < 1.1 * 2 * np.pi / 512] for f in (expected, found))
        expected[:, 0] = (expected[:, 0] - 220) % 512
        self.assertGreater(len(expected), 50)
        np.testing.assert_allclose(*(f[np.lexsort(f.T)] for f in (expected, found)), atol=1e-3)

    def test_corners_are_spread_by_solid_angle(self) -> None:
        random = np.random.RandomState(0)
        x, y, response = random.uniform(size=(3, 40_000))
        response[y < 0.5] += 1  # all of the upper half is stronger
        chosen = make_shard.select_corners(x, y, response, 1000)
        self.assertEqual(len(chosen), 1000)
        self.assertTrue((np.diff(chosen) > 0).all())
        latitude = np.abs(y[chosen] - 0.5)
        self.assertAlmostEqual((y[chosen] < 0.5).mean(), 0.5, delta=0.01)
        self.assertAlmostEqual((latitude < 0.125).mean(), np.sin(np.pi / 8), delta=0.01)
        # The strongest of each zone are taken.
        ahead = (y >= 6 / 16) & (y < 8 / 16)
        left = np.setdiff1d(np.flatnonzero(ahead), chosen)
        taken = np.intersect1d(np.flatnonzero(ahead), chosen)
        self.assertGreater(np.median(response[taken]), np.quantile(response[left], 0.95))

    def test_no_cell_has_more_than_its_quotas_of_corners(self) -> None:
        random = np.random.RandomState(0)
        x, y, response = random.uniform(size=(3, 5000))
        x[:4000], y[:4000], response[:4000] = 0.51, 0.51, 2  # a crowd in one cell
        chosen = make_shard.select_corners(x, y, response, 1000)
        quota = 1000 / 32 * np.sin(np.pi / 16) / 2  # solid angle of a cell at the equator
        self.assertAlmostEqual((chosen < 4000).sum(), 4 * quota, delta=1)
        # What the zone lacks is taken elsewhere.
        self.assertGreater(len(chosen), 900)

    def test_an_image_without_corners_has_none(self) -> None:
        self.assertEqual(make_shard.detect(np.zeros((256, 512, 3), np.uint8)).shape, (0, 3))

    def test_directions_are_in_the_frame_of_the_camera(self) -> None:
        random = np.random.RandomState(0)
        quaternion = random.standard_normal(4)
        quaternion /= np.linalg.norm(quaternion)
        x, y, z, w = quaternion
        rotation = np.array(  # world_from_camera
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )
        step = random.standard_normal(3)
        right, down, forward = rotation.T @ step / np.linalg.norm(step)
        quaternions = np.tile(quaternion, (4, 1))
        found = make_shard.travel_directions(np.outer(np.arange(4), step), quaternions)
        np.testing.assert_allclose(found, np.tile([-forward, right, -down], (4, 1)), atol=1e-12)
        standing = make_shard.travel_directions(np.zeros((4, 3)), quaternions)
        self.assertFalse(standing.any())


class SparsePointsTest(unittest.TestCase):
    def errors(self, model: NoiseModel) -> tuple[np.ndarray, ...]:
        """Relative errors, confidences and true ranges of many points."""
        frame, collected = drives.frame(), []
        for seed in range(20):
            points = simulate(frame, np.random.RandomState(seed), model)
            known = points.depth > 0
            measured, truth = points.depth[known] / points.scale, frame.range[known]
            collected.append((measured / truth - 1, points.confidence[known], truth))
        return tuple(np.concatenate(parts) for parts in zip(*collected))

    def test_without_noise_points_have_the_true_range_in_the_unit_of_the_map(self) -> None:
        error, confidence, _ = self.errors(EXACT)
        # A baseline of a million metres leaves the noise of the corner alone.
        self.assertLess(np.abs(error).max(), 0.05)
        self.assertGreater(confidence.min(), 0.98)

    def test_the_scale_is_that_of_the_whole_map(self) -> None:
        scales = {simulate(drives.frame(), np.random.RandomState(i), EXACT).scale for i in range(9)}
        self.assertEqual(len(scales), 9)
        self.assertTrue(0.05 <= min(scales) < 0.5 and 2 < max(scales) <= 20)

    def test_errors_grow_with_range_and_confidence_tells_them(self) -> None:
        model = NoiseModel(
            outliers=0, edge_outliers=0, estimate_bias=1, noise=(3, 3), min_confidence=0
        )
        error, confidence, truth = self.errors(model)
        error = np.abs(error)
        near, far = truth < 4, truth > 12
        self.assertGreater(np.median(error[far]), 2 * np.median(error[near]))
        self.assertLess(np.median(confidence[far]), np.median(confidence[near]))
        sure, unsure = confidence > 0.8, confidence < 0.4
        self.assertGreater(np.median(error[unsure]), 3 * np.median(error[sure]))
        # c = 1 / (1 + (e / 0.1)^2): the error that the confidence claims is the error there is.
        claimed = 0.1 * np.sqrt(1 / confidence[sure] - 1)
        self.assertAlmostEqual(np.median(error[sure] / claimed), 0.67, delta=0.1)

    def test_what_slam_would_not_hand_over_is_left_out(self) -> None:
        noisy = NoiseModel(estimate_bias=1, noise=(3, 3))
        _, confidence, _ = self.errors(noisy)
        self.assertGreaterEqual(confidence.min(), 0.5)
        _, confidence, _ = self.errors(replace(noisy, min_confidence=0))
        self.assertLess(confidence.min(), 0.4)

    def test_there_is_no_parallax_along_the_way(self) -> None:
        model = NoiseModel(outliers=0, edge_outliers=0, points=(2000, 2000))
        points = simulate(drives.frame(), np.random.RandomState(0), model)
        v, u = np.nonzero(points.depth)
        ahead = np.abs(bearings(u + 0.5, v + 0.5, drives.HEIGHT, drives.WIDTH)[:, 0])
        self.assertGreater(ahead.max(), 0.9)
        claimed = np.sqrt(1 / points.confidence[v, u] - 1)  # error, in tenths of the range
        self.assertGreater(np.median(claimed[ahead > 0.95]), 2 * np.median(claimed[ahead < 0.5]))

    def test_points_are_on_surfaces_and_as_many_as_asked_for(self) -> None:
        model = replace(NoiseModel(), points=(300, 300))
        for seed in range(5):
            points = simulate(drives.frame(), np.random.RandomState(seed), model)
            known = points.depth > 0
            self.assertTrue(200 < known.sum() <= 300)
            self.assertFalse((known & (drives.street() == 0)).any())
            self.assertTrue(((points.confidence > 0) == known).all())
            self.assertLessEqual(points.confidence.max(), 1)

    def test_some_points_are_wrong(self) -> None:
        error, _, _ = self.errors(replace(EXACT, outliers=0.2))
        self.assertAlmostEqual((np.abs(error) > 0.06).mean(), 0.2 * 0.95, delta=0.03)

    def test_ranges_beside_an_edge_come_from_within_two_deviations_of_the_corner(self) -> None:
        frame, edge = drives.frame(), drives.WIDTH // 2
        near_and_far = np.where(np.arange(drives.WIDTH) < edge, 5, 20) * np.ones((drives.HEIGHT, 1))
        for pixels in (1.0, 3.0):  # standard deviation of a corner
            features = frame.features.copy()
            features[:, 2] = pixels * 2 * np.pi / drives.WIDTH
            # Noise of a millionth of that: the range is that of a surface.
            model = replace(EXACT, edge_outliers=1, points=(9999, 9999), noise=(1e-6, 1e-6))
            wall = replace(frame, range=near_and_far.astype(np.float32), features=features)
            points = simulate(wall, np.random.RandomState(0), model)
            rows, columns = np.nonzero(points.depth)
            other = np.abs(points.depth[rows, columns] / points.scale / near_and_far[rows, columns] - 1)
            distance = np.abs(columns + 0.5 - edge)[other > 0.5]
            beside = distance[distance < drives.WIDTH // 4]  # the wall also begins at the seam
            self.assertTrue(0.5 * 2 * pixels < beside.max() <= 2 * pixels + 0.5, beside.max())

    def test_few_points_move_and_those_are_wrong(self) -> None:
        frame = drives.frame()
        moving = np.ones_like(frame.moving)
        moving[:, : drives.WIDTH // 2] = False
        model = replace(EXACT, points=(9999, 9999))
        points = simulate(replace(frame, moving=moving), np.random.RandomState(0), model)
        known = points.depth > 0
        self.assertLess((known & moving).sum(), 0.5 * (known & ~moving).sum())
        error = np.abs(points.depth[known] / points.scale / frame.range[known] - 1)
        self.assertGreater(np.median(error[moving[known]]), 0.2)
        self.assertLess(np.median(error[~moving[known]]), 0.01)

    def test_a_camera_that_stands_or_sees_nothing_gives_points_or_none(self) -> None:
        frame = replace(drives.frame(), travel=np.zeros(3, np.float32))
        self.assertGreater((simulate(frame, np.random.RandomState(0)).depth > 0).sum(), 50)
        for empty in (
            replace(frame, features=frame.features[:0]),
            replace(frame, range=np.zeros_like(frame.range)),
        ):
            self.assertFalse(simulate(empty, np.random.RandomState(0)).depth.any())


class BatchTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        paths = []
        for i, count in enumerate((2, 1)):
            paths.append(Path(folder.name) / f"{i}.npz")
            frames = [replace(drives.frame(j), camera_height=1 + i + j) for j in range(count)]
            shards.write(paths[-1], shards.pack(frames))
        self.frames = batches.Frames(paths)

    def test_frames_of_all_shards_are_counted_through(self) -> None:
        self.assertEqual(len(self.frames), 3)
        self.assertEqual([self.frames[i].camera_height for i in range(3)], [1, 2, 2])
        with self.assertRaisesRegex(ValueError, "no shards"):
            batches.Frames([])

    def test_a_step_has_its_batch_and_another_step_another(self) -> None:
        first, same, other = (batches.draw(self.frames, 5, i, 2, EXACT) for i in (7, 7, 8))
        for name, values in first.inputs.items():
            self.assertEqual(values.shape, (2, 3 if name == "image" else 1, 64, 128))
            self.assertTrue((values == same.inputs[name]).all())
            self.assertFalse((values == other.inputs[name]).all())
        self.assertTrue((first.truth == same.truth).all())

    def test_points_stay_on_what_they_measure_when_images_turn(self) -> None:
        batch = batches.draw(self.frames, 0, 0, 8, EXACT)
        known = batch.inputs["depth"] > 0
        measured = (batch.inputs["depth"] / batch.scale)[known]
        error = (measured / batch.truth[known] - 1).abs()
        self.assertGreater(known.sum(), 4000)
        self.assertLess(error.max(), 0.05)

    def test_half_of_the_keyframes_have_the_points_of_slam(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        points = np.array([[40, 10, drives.street()[40, 10], 0.5]], np.float32)
        path = Path(folder.name) / "keyframe.npz"
        shards.write(path, shards.pack([replace(drives.frame(), points=points)]))
        batch = batches.draw(batches.Frames([path]), 0, 0, 40, EXACT)
        counts = (batch.inputs["depth"] > 0).sum(dim=(1, 2, 3))
        self.assertTrue(8 < (counts == 1).sum() < 32)
        self.assertTrue((counts[counts != 1] > 100).all())

    def test_half_of_the_other_frames_have_points_of_stereo(self) -> None:
        model = replace(EXACT, from_stereo=0.5, points=(50, 50))
        batch = batches.draw(self.frames, 0, 0, 40, model)
        counts = (batch.inputs["depth"] > 0).sum(dim=(1, 2, 3))
        self.assertTrue(8 < (counts <= 50).sum() < 36)
        self.assertTrue(4 < (counts > 200).sum() < 32)

    def test_slam_s_points_are_thinned_to_every_density(self) -> None:
        rows, columns = np.nonzero(drives.street())
        points = [rows, columns, drives.street()[rows, columns], np.ones(len(rows))]
        frame = replace(drives.frame(), points=np.stack(points, axis=1).astype(np.float32))
        counts = np.array(
            [(from_slam(frame, np.random.RandomState(i)).depth > 0).sum() for i in range(60)]
        )
        whole = counts == len(rows)
        self.assertTrue(15 < whole.sum() < 45)
        self.assertLess(counts.min(), 0.05 * len(rows))
        self.assertTrue(5 < (counts[~whole] < 0.15 * len(rows)).sum())

    def test_images_turn_with_their_depth(self) -> None:
        frame = drives.frame()
        # Grey says how far it is.
        grey = np.where(frame.range > 0, np.clip(20 * frame.range, 1, 255), 0).astype(np.uint8)
        frame = replace(frame, rgb=np.repeat(grey[:, :, None], 3, axis=2))
        changed = 0
        for seed in range(8):
            random = np.random.RandomState(seed)
            points = simulate(frame, random, EXACT)
            sample = batches.augment(frame, points, random)
            brightness = np.corrcoef(
                sample.image.mean(axis=2).ravel(), np.minimum(sample.truth, 12).ravel()
            )[0, 1]
            self.assertGreater(brightness, 0.8)
            self.assertTrue(0 <= sample.image.min() and sample.image.max() <= 1)
            changed += not np.array_equal(sample.truth, frame.range)
        self.assertGreaterEqual(changed, 7)


class ComparePointsTest(unittest.TestCase):
    def test_sums_up_errors_by_confidence_and_range(self) -> None:
        error = np.array([0.1, -0.3, 0.2, 0.0])
        confidence = np.array([0.95, 0.1, 0.6, 0.95])
        truth = np.array([3.0, 30.0, 3.0, 3.0])
        part = compare_points.Compared(error, confidence, truth, np.array([10.0, 20.0]))
        first = compare_points.Compared(error[:2], confidence[:2], truth[:2], np.array([30.0, 80.0]))
        result = compare_points.summary([part, first])
        self.assertEqual(result["points of a frame, median"], 3)
        self.assertAlmostEqual(result["|ln error|, median"], 0.15)
        self.assertAlmostEqual(result["fraction with |ln error| > 0.25"], 2 / 6)
        self.assertAlmostEqual(result["confidence 0.9 to 1.0: fraction"], 0.5)
        self.assertAlmostEqual(result["confidence 0.9 to 1.0: |ln error|, median"], 0.1)
        self.assertAlmostEqual(result["metres 20 to 40: |ln error|, median"], 0.3)
        self.assertAlmostEqual(result["degrees to the nearest point, mean"], 35)

    def test_as_many_landmarks_are_simulated_as_slam_has_points(self) -> None:
        frame = replace(drives.frame(), points=np.ones((37, 4), np.float32))
        points = compare_points.as_many_landmarks(frame, np.random.RandomState(0))
        self.assertTrue(30 < (points.depth > 0).sum() <= 37)  # some share a pixel

    def test_gaps_are_angles_to_the_nearest_point_from_everywhere(self) -> None:
        height, width = 128, 256
        chosen = np.zeros((height, width), bool)
        self.assertTrue((compare_points.gaps(chosen) == 180).all())
        chosen[height // 2, width // 3] = True
        # From a direction drawn evenly, the cosine of the angle to a point is even in -1..1.
        cosine = np.sort(np.cos(np.radians(compare_points.gaps(chosen))))
        even = np.linspace(-1, 1, len(cosine))
        np.testing.assert_allclose(cosine, even, atol=0.01)
        chosen[0] = chosen[-1] = chosen[height // 2] = True  # both poles and the equator
        self.assertLess(compare_points.gaps(chosen).max(), 46)


if __name__ == "__main__":
    unittest.main()
