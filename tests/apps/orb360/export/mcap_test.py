"""`orb360 export --to mcap` against the run: read by the specification and by the definitions of
messages in the file, and by readers of MCAP and of ROS 2 messages by others."""

import base64
import math
import unittest
from typing import Any

import colmap_reader
import cv2
import mcap_reader
import node_readers
import numpy as np
import placed_run
from formats_test import matrix, poses_of
from rendered_run import RenderedRun

FORWARD_OF_OPTICAL = np.array([[0, 0, 1], [-1, 0, 0], [0, -1, 0]])  # REP 103


def pose_of(message: dict[str, Any]) -> np.ndarray:
    """The matrix of a transform or a pose."""
    position = message.get("translation") or message["position"]
    turn = message.get("rotation") or message["orientation"]
    pose = np.eye(4)
    pose[:3, :3] = colmap_reader.rotation(np.array([turn[c] for c in "wxyz"]))
    pose[:3, 3] = [position[c] for c in "xyz"]
    return pose


def stamp_of(message: dict[str, Any]) -> int:
    """Nanoseconds."""
    stamp = message["header"]["stamp"]
    return stamp["sec"] * 10**9 + stamp.get("nanosec", stamp.get("nsec"))


class McapExport(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.run_ = RenderedRun(20, 512)
        cls.trajectory = poses_of(cls.run_.result / "trajectory.txt")
        cls.local = cls.run_.export("mcap", name="local") / "run.mcap"
        placed_run.write_georeference(cls.run_.result / "georeference.json")
        cls.placed = cls.run_.export("mcap", "--images", "none", name="placed") / "run.mcap"
        placed_run.write_georeference(cls.run_.result / "georeference.json", "mean sea level")
        cls.over_sea = cls.run_.export("mcap", "--images", "none", "--frames", "keyframes",
                                       name="sea") / "run.mcap"
        model = cls.run_.export("colmap", "--frames", "all", "--images", "none", name="model")
        points = colmap_reader.read_binary(model / "sparse" / "0").points
        cls.points = np.array([point[0] for _, point in sorted(points.items())])
        cls.colors = np.array([point[1] for _, point in sorted(points.items())])

    @classmethod
    def tearDownClass(cls) -> None:
        cls.run_.temporary.cleanup()

    def check(self, file: dict[str, Any], is_placed: bool) -> None:
        """What must hold of the file, whoever has read it."""
        self.assertEqual(file["profile"], "ros2")
        topics = file["topics"]
        of_map = np.eye(4)
        scale, utc = 1.0, 0.0
        if is_placed:
            scale, utc = placed_run.SCALE, placed_run.UTC_AT_ZERO
            of_map[:3, :3] = placed_run.LOCAL_FROM_WORLD
            of_map[:3, 3] = placed_run.TRANSLATION
        times = [round((time + utc) * 1e9) for time in self.trajectory[:, 0]]
        poses = [matrix(row) for row in self.trajectory]
        for pose in poses:
            pose[:3, 3] *= scale
        kept = {"/tf_static", "/path", "/points"}
        for name, topic in topics.items():
            self.assertEqual(topic["encodings"], ["ros2msg", "cdr"])
            self.assertEqual("durability: 1\n" in topic["quality"], name in kept)
            count = 1 if name in kept else len(poses)
            self.assertEqual(len(topic["messages"]), count, name)
            for (logged, message), time in zip(topic["messages"], times):
                self.assertAlmostEqual(int(logged), time, delta=300)  # a double of UTC, ns
                if "header" in message:
                    self.assertEqual(stamp_of(message), int(logged))
        # The chain of transforms is the trajectory.
        [(_, static)] = topics["/tf_static"]["messages"]
        [optical] = static["transforms"]
        self.assertEqual((optical["header"]["frame_id"], optical["child_frame_id"]),
                         ("camera", "camera_optical"))
        camera_from_optical = pose_of(optical["transform"])
        np.testing.assert_allclose(camera_from_optical[:3, :3], FORWARD_OF_OPTICAL, atol=1e-12)
        [(_, path)] = topics["/path"]["messages"]
        self.assertEqual(path["header"]["frame_id"], "map")
        self.assertEqual(len(path["poses"]), len(poses))
        for pose, (_, moving), (_, camera), stop in zip(
                poses, topics["/tf"]["messages"], topics["/camera/pose"]["messages"],
                path["poses"]):
            [transform] = moving["transforms"]
            self.assertEqual((transform["header"]["frame_id"], transform["child_frame_id"]),
                             ("map", "camera"))
            self.assertEqual(stamp_of(transform), stamp_of(camera))
            self.assertEqual(stamp_of(stop), stamp_of(camera))
            map_from_camera = pose_of(transform["transform"])
            np.testing.assert_allclose(map_from_camera @ camera_from_optical, of_map @ pose,
                                       atol=1e-6)
            np.testing.assert_array_equal(pose_of(camera["pose"]), map_from_camera)
            np.testing.assert_array_equal(pose_of(stop["pose"]), map_from_camera)
        self.check_points(topics["/points"]["messages"][0][1],
                          placed_run.to_local(self.points) if is_placed else self.points)

    def check_points(self, cloud: dict[str, Any], expected: np.ndarray) -> None:
        self.assertEqual(cloud["header"]["frame_id"], "map")
        self.assertEqual([(f["name"], f["offset"], f["datatype"], f["count"])
                          for f in cloud["fields"]],
                         [("x", 0, 7, 1), ("y", 4, 7, 1), ("z", 8, 7, 1), ("rgb", 12, 7, 1)])
        self.assertEqual((cloud["height"], cloud["width"], cloud["point_step"], cloud["row_step"]),
                         (1, len(expected), 16, 16 * len(expected)))
        self.assertFalse(cloud["is_bigendian"])
        self.assertGreater(len(expected), 500)
        points = np.frombuffer(base64.b64decode(cloud["data"]),
                               [("xyz", "<f4", 3), ("bgr", "u1", 3), ("zero", "u1")])
        np.testing.assert_allclose(points["xyz"], expected, rtol=1e-6, atol=1e-5)
        np.testing.assert_array_equal(points["bgr"][:, ::-1], self.colors)
        self.assertFalse(points["zero"].any())

    def check_images(self, topics: dict[str, Any]) -> None:
        names = sorted(path for path in (self.run_.town / "rgb").iterdir())
        indices = np.round(self.trajectory[:, 0] / (self.trajectory[-1, 0] / (len(names) - 1)))
        messages = topics["/camera/image/compressed"]["messages"]
        self.assertEqual(len(messages), len(self.trajectory))
        for (_, image), index in zip(messages, indices):
            self.assertEqual(image["header"]["frame_id"], "camera_optical")
            self.assertEqual(image["format"], "jpeg")
            data = base64.b64decode(image["data"])
            self.assertTrue(data.startswith(b"\xff\xd8\xff"))
            is_ = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_COLOR)
            was = cv2.imread(str(names[int(index)]))
            self.assertLess(np.abs(was.astype(int) - is_).mean(), 2)

    def check_fixes(self, topics: dict[str, Any]) -> None:
        expected = placed_run.to_earth(self.trajectory[:, 1:4], "+proj=longlat +datum=WGS84")
        for (_, fix), place, pose in zip(topics["/fix"]["messages"], expected, self.trajectory):
            self.assertAlmostEqual(fix["longitude"], place[0], delta=1e-8)  # a millimetre
            self.assertAlmostEqual(fix["latitude"], place[1], delta=1e-8)
            self.assertAlmostEqual(float(fix["altitude"]), place[2], delta=1e-3)
            self.assertEqual((fix["status"]["status"], fix["position_covariance_type"]), (0, 1))
            distance = placed_run.SCALE * np.linalg.norm(pose[1:4])
            covariance = np.array(fix["position_covariance"], float).reshape(3, 3)
            horizontal = 1.2**2 + distance**2 * (np.radians(0.5)**2 + 0.01**2)
            vertical = 2.5**2 + (distance * np.radians(0.2))**2
            np.testing.assert_allclose(covariance, np.diag([horizontal, horizontal, vertical]),
                                       rtol=1e-6)

    def test_a_run_is_messages_in_its_own_world(self) -> None:
        file = mcap_reader.read(self.local)
        self.assertEqual(set(file["topics"]), {"/tf", "/tf_static", "/path", "/points",
                                               "/camera/pose", "/camera/image/compressed"})
        self.check(file, is_placed=False)
        self.check_images(file["topics"])

    def test_on_earth_the_map_is_east_north_up_and_times_are_utc(self) -> None:
        file = mcap_reader.read(self.placed)
        self.assertEqual(set(file["topics"]),
                         {"/tf", "/tf_static", "/path", "/points", "/camera/pose", "/fix"})
        self.check(file, is_placed=True)
        self.check_fixes(file["topics"])

    def test_a_height_over_the_sea_is_none_over_the_ellipsoid(self) -> None:
        fixes = mcap_reader.read(self.over_sea)["topics"]["/fix"]["messages"]
        keyframes = poses_of(self.run_.result / "keyframes.txt")
        self.assertEqual(len(fixes), len(keyframes))
        for _, fix in fixes:
            self.assertTrue(math.isnan(fix["altitude"]))
            self.assertEqual(fix["position_covariance"][8], math.inf)

    def test_other_readers_find_the_same(self) -> None:
        reason = node_readers.why_missing()
        if reason:
            self.skipTest(reason)
        file = node_readers.read("read_mcap.mjs", self.local)
        self.check(file, is_placed=False)
        self.check_images(file["topics"])
        file = node_readers.read("read_mcap.mjs", self.placed)
        self.check(file, is_placed=True)
        self.check_fixes(file["topics"])

    def test_the_same_export_twice_gives_the_same_bytes(self) -> None:
        placed_run.write_georeference(self.run_.result / "georeference.json")
        twice = self.run_.export("mcap", "--images", "none", name="twice") / "run.mcap"
        self.assertEqual(self.placed.read_bytes(), twice.read_bytes())


if __name__ == "__main__":
    unittest.main()
