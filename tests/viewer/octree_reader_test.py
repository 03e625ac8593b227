"""The page reads an octree as the program wrote it."""

import json
import os
import random
import struct
import subprocess
import tempfile
import unittest
from pathlib import Path

BUILD = Path(os.environ["ORB360_BINARY_DIR"])
HEADER = ("ply\nformat binary_little_endian 1.0\nelement vertex {}\n"
          "property float x\nproperty float y\nproperty float z\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n")


class OctreeReader(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.run_folder = Path(folder.name)
        numbers = random.Random(1)
        # The colour tells which point it is.
        self.points = [(numbers.uniform(-30, 50), numbers.uniform(-9, 9), numbers.gauss(0, 1))
                       for _ in range(60000)]
        packed = b"".join(struct.pack("<3f3B", *point, i & 255, i >> 8 & 255, i >> 16)
                          for i, point in enumerate(self.points))
        (self.run_folder / "cloud.ply").write_bytes(HEADER.format(len(self.points)).encode() + packed)
        (self.run_folder / "summary.json").write_text(json.dumps({"input": "made"}))
        subprocess.run([BUILD / "orb360", "report", self.run_folder], check=True,
                       stdout=subprocess.DEVNULL)
        self.octree = self.run_folder / "cloud.octree"

    def read(self) -> subprocess.CompletedProcess[str]:
        return subprocess.run(["node", BUILD / "viewer_tests" / "read_octree.mjs", self.octree,
                               BUILD / "viewer_web"], check=False, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE)

    def test_finds_every_point_where_it_is(self) -> None:
        result = self.read()
        self.assertEqual(result.stderr, "")
        seen = set()
        for line in result.stdout.splitlines():
            x, y, z, red, green, blue, confidence, step = map(float, line.split())
            number = int(red) | int(green) << 8 | int(blue) << 16
            seen.add(number)
            self.assertEqual(confidence, 0)
            for found, true in zip((x, y, z), self.points[number]):
                self.assertLessEqual(abs(found - true), 0.5 * step + 1e-5)
        self.assertEqual(len(result.stdout.splitlines()), len(self.points))
        self.assertEqual(len(seen), len(self.points))

    def test_says_that_a_file_is_damaged(self) -> None:
        whole = self.octree.read_bytes()
        for content in (whole[:50], whole[:-100], whole[:1000] + b"x" + whole[1001:],
                        b"x" + whole[1:]):
            self.octree.write_bytes(content)
            result = self.read()
            self.assertEqual(result.returncode, 1)
            self.assertRegex(result.stderr, "^(the octree is (damaged|truncated)|this is no octree)")


if __name__ == "__main__":
    unittest.main()
