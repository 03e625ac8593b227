"""What `orb360 export` writes, read by parsers of its own that follow each format's documentation
(docs/formats/export.md names it), and compared with the files of the run and with the input."""

import json
import unittest

import colmap_reader
import cv2
import numpy as np
from rendered_run import RenderedRun


def poses_of(path) -> np.ndarray:
    """Rows `timestamp tx ty tz qx qy qz qw`."""
    return np.loadtxt(path, ndmin=2)


def matrix(row: np.ndarray) -> np.ndarray:
    """world_from_camera of such a row."""
    pose = np.eye(4)
    pose[:3, :3] = colmap_reader.rotation(row[[7, 4, 5, 6]])
    pose[:3, 3] = row[1:4]
    return pose


def direction_of(pixel: np.ndarray, width: int, height: int) -> np.ndarray:
    """Of pixels (n x 2) of a panorama, in the frame x right, y down, z forward."""
    longitude = (pixel[:, 0] / width - 0.5) * 2 * np.pi
    latitude = (0.5 - pixel[:, 1] / height) * np.pi
    return np.stack([np.cos(latitude) * np.sin(longitude), -np.sin(latitude),
                     np.cos(latitude) * np.cos(longitude)], axis=1)


class Formats(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.run_ = RenderedRun(30, 512)
        # Exporters take a mask from the folder of the run; a quarter of the sphere is excluded.
        mask = np.full((256, 512), 255, np.uint8)
        mask[:, 384:] = 0
        cv2.imwrite(str(cls.run_.result / "mask.png"), mask)
        cls.trajectory = poses_of(cls.run_.result / "trajectory.txt")
        cls.keyframes = poses_of(cls.run_.result / "keyframes.txt")

    @classmethod
    def tearDownClass(cls) -> None:
        cls.run_.temporary.cleanup()

    def test_tum_has_the_poses_of_the_run(self) -> None:
        read = poses_of(self.run_.export("tum") / "trajectory.txt")
        np.testing.assert_allclose(read, self.trajectory, atol=1e-8)
        read = poses_of(self.run_.export("tum", "--frames", "keyframes", name="tum_keyframes")
                        / "trajectory.txt")
        np.testing.assert_allclose(read, self.keyframes, atol=1e-8)

    def test_kitti_has_the_poses_in_the_frame_of_the_first_camera(self) -> None:
        folder = self.run_.export("kitti")
        rows = np.loadtxt(folder / "poses.txt").reshape(-1, 3, 4)
        times = np.loadtxt(folder / "times.txt")
        self.assertEqual(len(rows), len(self.trajectory))
        np.testing.assert_allclose(times, self.trajectory[:, 0] - self.trajectory[0, 0], atol=1e-8)
        first = np.linalg.inv(matrix(self.trajectory[0]))
        for row, pose in zip(rows, self.trajectory):
            np.testing.assert_allclose(row, (first @ matrix(pose))[:3], atol=1e-7)
        # The camera drives ahead, which is z.
        self.assertGreater(rows[-1, 2, 3], 3 * abs(rows[-1, 1, 3]))

    def test_euroc_has_nanoseconds_and_the_scalar_of_the_quaternion_first(self) -> None:
        path = self.run_.export("euroc") / "trajectory.csv"
        header, *lines = path.read_text().splitlines()
        self.assertTrue(header.startswith("#timestamp [ns],p_RS_R_x [m]"))
        self.assertEqual(len(lines), len(self.trajectory))
        for line, pose in zip(lines, self.trajectory):
            words = line.split(",")
            self.assertEqual(int(words[0]), round(pose[0] * 1e9))
            values = np.array([float(word) for word in words[1:]])
            np.testing.assert_allclose(values[:3], pose[1:4], atol=1e-8)
            np.testing.assert_allclose(values[3:], pose[[7, 4, 5, 6]], atol=1e-8)

    def check_model(self, model: colmap_reader.Model, folder, views: int) -> None:
        """What must hold of any COLMAP model of the keyframes."""
        self.assertEqual(len(model.images), views * len(self.keyframes))
        self.assertEqual(len(model.frames), len(self.keyframes))
        errors = colmap_reader.reprojection_errors(model)
        self.assertGreater(len(errors), 1000)
        self.assertLess(np.median(errors), 1.0)
        self.assertLess(np.mean(errors), 1.0)
        stated = [point[2] for point in model.points.values()]
        tracks = [len(point[3]) for point in model.points.values()]
        self.assertAlmostEqual(np.average(stated, weights=tracks), np.mean(errors), places=6)
        # Tracks and pixels refer to each other.
        for number, (_, _, _, track) in model.points.items():
            for image, index in track:
                self.assertEqual(model.images[image].points[index], number)
        self.assertEqual(sum(tracks), len(errors))
        # An image's pose is that of its rig and of the sensor in it.
        for rig, pose, data in model.frames.values():
            self.assertEqual(len(data), views)
            for sensor, image in data:
                self.assertEqual(model.images[image].camera, sensor)
                self.assertTrue((folder / "images" / model.images[image].name).exists())
                sensor_from_rig = model.rigs[rig][sensor]
                turn = (np.eye(3) if sensor_from_rig is None
                        else colmap_reader.rotation(sensor_from_rig[:4]))
                is_ = model.images[image].pose
                np.testing.assert_allclose(colmap_reader.rotation(is_[:4]),
                                           turn @ colmap_reader.rotation(pose[:4]), atol=1e-9)
                np.testing.assert_allclose(is_[4:], turn @ pose[4:], atol=1e-9)
        poses = [pose for _, pose, _ in model.frames.values()]
        for pose, keyframe in zip(poses, self.keyframes):
            camera_from_world = np.linalg.inv(matrix(keyframe))
            np.testing.assert_allclose(colmap_reader.rotation(pose[:4]), camera_from_world[:3, :3],
                                       atol=1e-7)
            np.testing.assert_allclose(pose[4:], camera_from_world[:3, 3], atol=1e-7)

    def test_colmap_panoramas_reproject_and_text_says_the_same(self) -> None:
        folder = self.run_.export("colmap")
        model = colmap_reader.read_binary(folder / "sparse" / "0")
        self.assertEqual(model.cameras, {1: (17, 512, 256, [512.0, 256.0])})
        self.check_model(model, folder, 1)
        for image in model.images.values():
            was = cv2.imread(str(self.run_.town / "rgb" / image.name))
            is_ = cv2.imread(str(folder / "images" / image.name))
            self.assertLess(np.abs(was.astype(int) - is_).mean(), 2)
        text = colmap_reader.read_text(
            self.run_.export("colmap", "--text", "--images", "none", name="text") / "sparse" / "0")
        self.assertEqual(text.cameras, model.cameras)
        self.assertEqual(text.points.keys(), model.points.keys())
        for number, (position, color, error, track) in model.points.items():
            np.testing.assert_array_equal(text.points[number][0], position)
            self.assertEqual(text.points[number][1:], (color, error, track))
        for number, image in model.images.items():
            np.testing.assert_array_equal(text.images[number].pose, image.pose)
            np.testing.assert_array_equal(text.images[number].pixels, image.pixels)
            np.testing.assert_array_equal(text.images[number].points, image.points)
        for number, frame in model.frames.items():
            np.testing.assert_array_equal(text.frames[number][1], frame[1])
            self.assertEqual(text.frames[number][2], frame[2])

    def test_colmap_rig_reprojects_shows_the_panorama_and_has_masks(self) -> None:
        folder = self.run_.export("colmap-rig")
        model = colmap_reader.read_binary(folder / "sparse" / "0")
        self.check_model(model, folder, 6)
        for kind, width, height, (fx, fy, cx, cy) in model.cameras.values():
            self.assertEqual((kind, fx, cx, cy), (1, fy, width / 2, height / 2))
            # Rounding to an even width changes the angle by less than half a degree.
            self.assertAlmostEqual(np.degrees(2 * np.arctan(width / 2 / fx)), 96, delta=0.5)
        frame = sorted(model.frames)[len(model.frames) // 2]
        rig, _, data = model.frames[frame]
        name = model.images[data[0][1]].name.split("/")[1]
        panorama = cv2.imread(str(self.run_.town / "rgb" / name)).astype(float)
        for sensor, number in data:
            image = model.images[number]
            face = cv2.imread(str(folder / "images" / image.name)).astype(float)
            mask = cv2.imread(str(folder / "masks" / (image.name + ".png")), cv2.IMREAD_UNCHANGED)
            self.assertEqual(mask.shape, face.shape[:2])
            _, width, height, (fx, fy, cx, cy) = model.cameras[sensor]
            # The colours of the panorama, projected into the face.
            u, v = np.meshgrid(np.arange(512) + 0.5, np.arange(256) + 0.5)
            rays = direction_of(np.stack([u.ravel(), v.ravel()], axis=1), 512, 256)
            sensor_from_rig = model.rigs[rig][sensor]
            if sensor_from_rig is not None:
                rays = rays @ colmap_reader.rotation(sensor_from_rig[:4]).T
            x, y = fx * rays[:, 0] / rays[:, 2] + cx, fy * rays[:, 1] / rays[:, 2] + cy
            inside = (rays[:, 2] > 0) & (x > 1) & (x < width - 1) & (y > 1) & (y < height - 1)
            column, row = x[inside].astype(int), y[inside].astype(int)
            difference = np.abs(face[row, column] - panorama.reshape(-1, 3)[inside])
            self.assertLess(np.median(difference), 4, image.name)
            excluded = u.ravel()[inside] >= 384
            agrees = (mask[row, column] == 0) == excluded
            self.assertGreater(agrees.mean(), 0.97, image.name)

    def test_nerfstudio_follows_its_documented_conventions(self) -> None:
        for views, name in (("sphere", "nerf"), ("cube", "nerf_cube"), ("8", "nerf_ring")):
            with self.subTest(views):
                self.check_nerfstudio(views, name)

    def check_nerfstudio(self, views: str, name: str) -> None:
        folder = self.run_.export("nerfstudio", "--views", views, name=name)
        scene = json.loads((folder / "transforms.json").read_text())
        number = {"sphere": 1, "cube": 6, "8": 8}[views]
        self.assertEqual(len(scene["frames"]), number * len(self.keyframes))
        np.testing.assert_array_equal(scene["applied_transform"], np.eye(4)[:3])
        for frame in scene["frames"]:
            image = cv2.imread(str(folder / frame["file_path"]))
            self.assertEqual(image.shape, (scene["h"], scene["w"], 3))
            self.assertTrue((folder / frame["mask_path"]).exists())
            pose = np.array(frame["transform_matrix"])
            np.testing.assert_allclose(pose[:3, :3].T @ pose[:3, :3], np.eye(3), atol=1e-9)
            self.assertAlmostEqual(np.linalg.det(pose[:3, :3]), 1.0)
            np.testing.assert_array_equal(pose[3], [0, 0, 0, 1])
        # What the rays of nerfstudio's cameras (cameras.py) meet are the points of the COLMAP model.
        panoramas = self.run_.folder / "colmap_of_nerf"
        if not panoramas.exists():
            self.run_.export("colmap", "--images", "none", name="colmap_of_nerf")
        model = colmap_reader.read_binary(panoramas / "sparse" / "0")
        pairs = 0
        for index, image in enumerate(sorted(model.images.items())):
            seen = image[1].points != colmap_reader.NO_POINT
            points = np.array([model.points[int(i)][0] for i in image[1].points[seen]])
            rays = direction_of(image[1].pixels[seen], 512, 256)
            for frame in scene["frames"][number * index:number * (index + 1)]:
                pose = np.array(frame["transform_matrix"])
                local = (points - pose[:3, 3]) @ pose[:3, :3]  # x right, y up, z back
                if scene["camera_model"] == "EQUIRECTANGULAR":
                    theta = np.arctan2(local[:, 0], -local[:, 2])
                    phi = np.arctan2(local[:, 1], np.hypot(local[:, 0], local[:, 2]))
                    u = theta / np.pi * scene["fl_x"] + scene["cx"]
                    v = -phi / np.pi * scene["fl_y"] + scene["cy"]
                    expected = image[1].pixels[seen]
                else:
                    self.assertEqual(scene["camera_model"], "PINHOLE")
                    # The pixel of the ray to the observation in the same camera.
                    world = rays @ matrix(self.keyframes[index])[:3, :3].T
                    view = world @ pose[:3, :3]
                    front = (local[:, 2] < -0.3 * np.linalg.norm(local, axis=1)) & (view[:, 2] < 0)
                    local, view = local[front], view[front]
                    u, v = (-scene["fl_x"] * local[:, 0] / local[:, 2] + scene["cx"],
                            scene["fl_y"] * local[:, 1] / local[:, 2] + scene["cy"])
                    expected = np.stack([-scene["fl_x"] * view[:, 0] / view[:, 2] + scene["cx"],
                                         scene["fl_y"] * view[:, 1] / view[:, 2] + scene["cy"]], 1)
                if len(expected) < 10:
                    continue
                du = np.abs(u - expected[:, 0])
                if scene["camera_model"] == "EQUIRECTANGULAR":
                    du = np.minimum(du, scene["w"] - du)
                self.assertLess(np.median(np.hypot(du, v - expected[:, 1])), 1.0)
                pairs += len(expected)
        self.assertGreater(pairs, 1000)
        # z is up: the street below the camera is lower, by the camera's height.
        header, data = (folder / scene["ply_file_path"]).read_bytes().split(b"end_header\n", 1)
        cloud = np.frombuffer(data, np.dtype([("p", "<3f4"), ("c", "3u1")]))
        self.assertIn(f"element vertex {len(cloud)}\n".encode(), header)
        self.assertEqual(len(cloud), len(model.points))
        self.assertLess(np.percentile(cloud["p"][:, 2], 5), -0.8)

    def test_opensfm_reprojects_by_its_documented_model(self) -> None:
        folder = self.run_.export("opensfm")
        [scene] = json.loads((folder / "reconstruction.json").read_text())
        [(camera, parameters)] = scene["cameras"].items()
        self.assertEqual(parameters, {"projection_type": "spherical", "width": 512, "height": 256})
        self.assertEqual(len(scene["shots"]), len(self.keyframes))
        model = colmap_reader.read_binary(
            self.run_.export("colmap", "--images", "none", name="colmap_of_sfm") / "sparse" / "0")
        self.assertEqual(len(scene["points"]), len(model.points))
        for image, keyframe in zip(model.images.values(), self.keyframes):
            shot = scene["shots"][image.name]
            self.assertEqual(shot["camera"], camera)
            self.assertAlmostEqual(shot["capture_time"], keyframe[0], places=8)
            self.assertTrue((folder / "images" / image.name).exists())
            turn, _ = cv2.Rodrigues(np.array(shot["rotation"]))  # camera from world
            points = np.array([scene["points"][str(int(i) - 1)]["coordinates"]
                               for i in image.points])
            x, y, z = (points @ turn.T + shot["translation"]).T
            # Normalized coordinates; the origin is the image's centre.
            u = np.arctan2(x, z) / (2 * np.pi)
            v = -np.arctan2(-y, np.hypot(x, z)) / (2 * np.pi)
            du = np.abs((u + 0.5) * 512 - image.pixels[:, 0])
            dv = v * 512 + 128 - image.pixels[:, 1]
            self.assertLess(np.median(np.hypot(np.minimum(du, 512 - du), dv)), 1.0)

    def test_max_points_keeps_the_most_observed_and_their_tracks(self) -> None:
        folder = self.run_.export("colmap", "--max-points", 100, "--images", "none", name="few")
        model = colmap_reader.read_binary(folder / "sparse" / "0")
        self.assertEqual(len(model.points), 100)
        every = colmap_reader.read_binary(
            self.run_.export("colmap", "--images", "none", name="every") / "sparse" / "0")
        lengths = sorted((len(p[3]) for p in every.points.values()), reverse=True)
        self.assertEqual(sorted((len(p[3]) for p in model.points.values()), reverse=True),
                         lengths[:100])

    def test_the_same_export_twice_gives_the_same_bytes(self) -> None:
        once = self.run_.export("colmap-rig", name="once")
        twice = self.run_.export("colmap-rig", name="twice")
        files = sorted(path.relative_to(once) for path in once.rglob("*") if path.is_file())
        self.assertGreater(len(files), 12 * len(self.keyframes))
        for path in files:
            self.assertEqual((once / path).read_bytes(), (twice / path).read_bytes(), path)


if __name__ == "__main__":
    unittest.main()
