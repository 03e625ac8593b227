"""Writes the folder of a run whose cloud is a made-up town, 800 m wide:
/usr/bin/python3 tests/viewer/synthetic_cloud.py POINTS FOLDER. For measuring the viewer."""

import json
import sys
from pathlib import Path

import numpy as np

POINT = np.dtype([("position", "<f4", 3), ("normal", "<f4", 3), ("color", "u1", 3),
                  ("confidence", "<f4")])
PROPERTIES = ("\nproperty float x\nproperty float y\nproperty float z\n"
              "property float nx\nproperty float ny\nproperty float nz\n"
              "property uchar red\nproperty uchar green\nproperty uchar blue\n"
              "property float confidence\nend_header\n")
HEADER_BYTES = 160  # before the properties, as slam/io/ply.cc writes it


def header(count: int) -> bytes:
    begin = "ply\nformat binary_little_endian 1.0\n"
    element = f"\nelement vertex {count}"
    comment = "comment made by tests/viewer/synthetic_cloud.py"
    return (begin + comment.ljust(HEADER_BYTES - len(begin) - len(element)) + element
            + PROPERTIES).encode()


def piece(count: int, random: np.random.Generator) -> np.ndarray:
    """Points of the ground and of house fronts at every 40 m."""
    points = np.zeros(count, POINT)
    is_ground = random.random(count) < 0.5
    x, y = random.uniform(-400, 400, (2, count))
    points["position"][:, 0] = np.where(is_ground, x, np.round(x / 40) * 40 + 10)
    points["position"][:, 1] = y
    points["position"][:, 2] = np.where(is_ground, -1.6, random.uniform(-1.6, 14, count))
    points["normal"][:, 2] = is_ground
    points["normal"][:, 0] = ~is_ground
    points["color"][:, 0] = 90 + np.abs(x) // 5 % 20 * 6
    points["color"][:, 1] = 100 + np.abs(y) // 7 % 15 * 6
    points["color"][:, 2] = np.where(is_ground, 80, 140)
    points["confidence"] = random.uniform(0.1, 1, count)
    return points


def main() -> None:
    count, folder = int(sys.argv[1]), Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    random = np.random.default_rng(0)
    with (folder / "cloud.ply").open("wb") as file:
        file.write(header(count))
        for begin in range(0, count, 1_000_000):
            file.write(piece(min(1_000_000, count - begin), random).tobytes())
    summary = {"input": f"made-up town of {count} points", "cloud": {"voxel_size": 0.05}}
    (folder / "summary.json").write_text(json.dumps(summary))


if __name__ == "__main__":
    main()
