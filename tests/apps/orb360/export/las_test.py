"""`orb360 export --to las` against the cloud that was exported: read by the layout that the
specification of LAS 1.4 gives, and by another program's reader (copc)."""

import subprocess
import unittest
from pathlib import Path
from typing import Any

import node_readers
import numpy as np
import placed_run
from rendered_run import BUILD, RenderedRun

HEADER = np.dtype([
    ("signature", "S4"), ("source", "<u2"), ("encoding", "<u2"), ("guid", "V16"),
    ("version", "u1", 2), ("system", "S32"), ("software", "S32"), ("day", "<u2"), ("year", "<u2"),
    ("header_size", "<u2"), ("offset_to_points", "<u4"), ("records", "<u4"), ("format", "u1"),
    ("point_size", "<u2"), ("legacy", "<u4", 6), ("scale", "<f8", 3), ("offset", "<f8", 3),
    ("bounds", "<f8", (3, 2)), ("waveforms", "<u8"), ("extended", "<u8"), ("extended_count", "<u4"),
    ("count", "<u8"), ("by_return", "<u8", 15)])
RECORD = np.dtype([("reserved", "<u2"), ("user", "S16"), ("id", "<u2"), ("size", "<u2"),
                   ("description", "S32")])
POINT = [("xyz", "<i4", 3), ("intensity", "<u2"), ("returns", "u1"), ("flags", "u1"),
         ("class", "u1"), ("user", "u1"), ("angle", "<i2"), ("source", "<u2"), ("time", "<f8"),
         ("rgb", "<u2", 3)]
SURFACE = np.dtype([("xyz", "<f4", 3), ("normal", "<f4", 3), ("rgb", "u1", 3),
                    ("confidence", "<f4")])


class Las:
    def __init__(self, path: Path) -> None:
        data = path.read_bytes()
        self.header = np.frombuffer(data, HEADER, 1)[0]
        at, self.records = int(self.header["header_size"]), {}
        for _ in range(self.header["records"]):
            record = np.frombuffer(data, RECORD, 1, at)[0]
            at += RECORD.itemsize
            self.records[record["user"].decode(), int(record["id"])] = data[at:at + record["size"]]
            at += int(record["size"])
        assert at == self.header["offset_to_points"]
        extra = [("confidence", "<f4")] if ("LASF_Spec", 4) in self.records else []
        layout = np.dtype(POINT + extra)
        assert layout.itemsize == self.header["point_size"]
        self.points = np.frombuffer(data, layout, offset=at)
        self.xyz = self.points["xyz"] * self.header["scale"] + self.header["offset"]


def write_surface(path: Path, count: int) -> np.ndarray:
    """A cloud as `orb360 run` writes it with a network (docs/formats/cloud.md)."""
    random = np.random.default_rng(5)
    points = np.zeros(count, SURFACE)
    points["xyz"] = random.normal(0, [80, 60, 4], (count, 3))
    points["normal"] = [0, 0, 1]
    points["rgb"] = random.integers(0, 256, (count, 3))
    points["confidence"] = random.uniform(0.01, 1, count)
    begin = b"ply\nformat binary_little_endian 1.0\n"
    element = f"\nelement vertex {count}\n".encode()
    comment = b"comment confidence c".ljust(160 + 1 - len(begin) - len(element))
    names = ["float x", "float y", "float z", "float nx", "float ny", "float nz", "uchar red",
             "uchar green", "uchar blue", "float confidence"]
    properties = "".join(f"property {name}\n" for name in names) + "end_header\n"
    path.write_bytes(begin + comment + element + properties.encode() + points.tobytes())
    return points


class LasExport(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cls.run_ = RenderedRun(12, 512)
        result = cls.run_.result
        landmarks = result / "cloud.ply"
        data = landmarks.read_bytes().split(b"end_header\n", 1)[1]
        cls.landmarks = np.frombuffer(data, [("xyz", "<f4", 3), ("rgb", "u1", 3)])
        cls.of_landmarks = cls.run_.export("las", name="landmarks") / "cloud.las"
        cls.surface = write_surface(landmarks, 20_000)
        cls.local = cls.run_.export("las", name="local") / "cloud.las"
        placed_run.write_georeference(result / "georeference.json")
        cls.placed = cls.run_.export("las", name="placed") / "cloud.las"

    @classmethod
    def tearDownClass(cls) -> None:
        cls.run_.temporary.cleanup()

    def check(self, las: Las, cloud: np.ndarray, expected: np.ndarray, step: float) -> None:
        header = las.header
        self.assertEqual(header["signature"], b"LASF")
        self.assertEqual(list(header["version"]), [1, 4])
        self.assertEqual(header["format"], 7)
        self.assertEqual(header["encoding"], 16)
        self.assertEqual(header["count"], len(cloud))
        self.assertEqual(list(header["by_return"]), [len(cloud)] + 14 * [0])
        self.assertFalse(header["legacy"].any())
        self.assertEqual(len(las.points), len(cloud))
        self.assertEqual(list(header["scale"]), 3 * [step])
        np.testing.assert_allclose(las.xyz, expected, atol=0.51 * step)
        np.testing.assert_allclose(header["bounds"][:, 0], las.xyz.max(axis=0), atol=1e-9)
        np.testing.assert_allclose(header["bounds"][:, 1], las.xyz.min(axis=0), atol=1e-9)
        np.testing.assert_array_equal(las.points["rgb"], cloud["rgb"].astype(int) * 257)
        self.assertTrue((las.points["returns"] == 0x11).all())

    def test_landmarks_have_the_coordinates_of_the_run(self) -> None:
        self.assertGreater(len(self.landmarks), 500)
        las = Las(self.of_landmarks)
        self.assertEqual(las.records, {})
        self.check(las, self.landmarks, self.landmarks["xyz"], 1e-3)

    def test_points_of_a_dense_cloud_keep_their_confidence(self) -> None:
        las = Las(self.local)
        self.check(las, self.surface, self.surface["xyz"], 1e-3)
        np.testing.assert_array_equal(las.points["confidence"], self.surface["confidence"])
        self.assertEqual(las.records["LASF_Spec", 4][4:14], b"confidence")

    def test_on_earth_coordinates_are_utm_by_another_program(self) -> None:
        las = Las(self.placed)
        expected = placed_run.to_earth(self.surface["xyz"].astype(float),
                                       "+proj=utm +zone=32 +datum=WGS84")
        # Half a step, and what cs2cs was given, rounded to a micrometre.
        self.check(las, self.surface, expected, 1e-3)
        wkt = las.records["LASF_Projection", 2112].rstrip(b"\0").decode()
        # GDAL knows the coordinate system by its text.
        done = subprocess.run(["gdalsrsinfo", "-e", "-o", "epsg", wkt], check=True, text=True,
                              stdout=subprocess.PIPE)
        self.assertIn("EPSG:32632", done.stdout)

    def test_another_reader_finds_the_same(self) -> None:
        reason = node_readers.why_missing()
        if reason:
            self.skipTest(reason)
        for path, cloud in ((self.of_landmarks, self.landmarks), (self.local, self.surface),
                            (self.placed, self.surface)):
            with self.subTest(path.parent.name):
                self.check_node(node_readers.read("read_las.mjs", path), Las(path), cloud)

    def check_node(self, read: dict[str, Any], las: Las, cloud: np.ndarray) -> None:
        header, points = read["header"], read["points"]
        self.assertEqual(read["size"], read["end"])  # nothing behind the points
        self.assertEqual((header["majorVersion"], header["minorVersion"]), (1, 4))
        self.assertEqual(header["pointDataRecordFormat"], 7)
        self.assertEqual(header["pointCount"], len(cloud))
        self.assertEqual(header["pointCountByReturn"], [len(cloud)] + 14 * [0])
        self.assertEqual(header["systemIdentifier"], "OTHER")
        self.assertEqual(header["generatingSoftware"], "orb360")
        np.testing.assert_array_equal(header["scale"], las.header["scale"])
        np.testing.assert_array_equal(header["offset"], las.header["offset"])
        xyz = np.stack([points["X"], points["Y"], points["Z"]], axis=1)
        np.testing.assert_allclose(xyz, las.xyz, atol=1e-9)
        np.testing.assert_allclose(header["min"], xyz.min(axis=0), atol=1e-9)
        np.testing.assert_allclose(header["max"], xyz.max(axis=0), atol=1e-9)
        rgb = np.stack([points["Red"], points["Green"], points["Blue"]], axis=1)
        np.testing.assert_array_equal(rgb, cloud["rgb"].astype(int) * 257)
        self.assertEqual(set(points["ReturnNumber"] + points["NumberOfReturns"]), {1})
        if "confidence" in cloud.dtype.names:
            np.testing.assert_array_equal(np.float32(points["confidence"]), cloud["confidence"])
        self.assertEqual("UTM zone 32N" in read["wkt"],
                         ("LASF_Projection", 2112) in las.records)

    def test_the_program_says_where_the_points_lie(self) -> None:
        def said(reference: str) -> str:
            placed_run.write_georeference(self.run_.result / "georeference.json", reference)
            out = self.run_.folder / reference
            return subprocess.run([BUILD / "orb360", "export", self.run_.result, "--to", "las",
                                   "--out", out], check=True, text=True,
                                  stdout=subprocess.PIPE).stdout

        self.assertIn("EPSG:32632, and heights over the ellipsoid", said("WGS 84 ellipsoid"))
        self.assertIn("EPSG:32632, and heights over mean sea level", said("mean sea level"))

    def test_the_same_export_twice_gives_the_same_bytes(self) -> None:
        placed_run.write_georeference(self.run_.result / "georeference.json")
        twice = self.run_.export("las", name="twice") / "cloud.las"
        self.assertEqual(self.placed.read_bytes(), twice.read_bytes())


if __name__ == "__main__":
    unittest.main()
