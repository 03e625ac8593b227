"""Reads the files of a COLMAP model (https://colmap.github.io/format.html) and projects its points,
independently of orb360."""

import struct
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

EQUIRECTANGULAR, PINHOLE = 17, 1
NAMES = {"EQUIRECTANGULAR": EQUIRECTANGULAR, "PINHOLE": PINHOLE}
PARAMETERS = {EQUIRECTANGULAR: 2, PINHOLE: 4}
NO_POINT = 2**64 - 1


@dataclass
class Image:
    pose: np.ndarray  # qw qx qy qz tx ty tz, camera from world
    camera: int
    name: str
    pixels: np.ndarray  # n x 2
    points: np.ndarray  # n ids; NO_POINT: none


@dataclass
class Model:
    cameras: dict[int, tuple[int, int, int, list[float]]] = field(default_factory=dict)
    rigs: dict[int, dict[int, np.ndarray | None]] = field(default_factory=dict)
    frames: dict[int, tuple[int, np.ndarray, list[tuple[int, int]]]] = field(default_factory=dict)
    images: dict[int, Image] = field(default_factory=dict)
    # position, colour, error, track of (image, index)
    points: dict[int, tuple[np.ndarray, tuple[int, ...], float, list[tuple[int, int]]]] = field(
        default_factory=dict)


class Bytes:
    def __init__(self, path: Path) -> None:
        self.data, self.at = path.read_bytes(), 0

    def take(self, code: str) -> tuple:
        values = struct.unpack_from("<" + code, self.data, self.at)
        self.at += struct.calcsize("<" + code)
        return values

    def one(self, code: str):
        return self.take(code)[0]

    def text(self) -> str:
        end = self.data.index(b"\0", self.at)
        name, self.at = self.data[self.at:end].decode(), end + 1
        return name


def read_binary(folder: Path) -> Model:
    model = Model()
    file = Bytes(folder / "cameras.bin")
    for _ in range(file.one("Q")):
        number, kind, width, height = file.take("IiQQ")
        model.cameras[number] = (kind, width, height, list(file.take("d" * PARAMETERS[kind])))
    assert file.at == len(file.data)
    file = Bytes(folder / "rigs.bin")
    for _ in range(file.one("Q")):
        number, sensors = file.take("II")
        kind, reference = file.take("iI")
        assert kind == 0
        model.rigs[number] = {reference: None}
        for _ in range(sensors - 1):
            kind, sensor, has_pose = file.take("iIB")
            assert (kind, has_pose) == (0, 1)
            model.rigs[number][sensor] = np.array(file.take("7d"))
    assert file.at == len(file.data)
    file = Bytes(folder / "frames.bin")
    for _ in range(file.one("Q")):
        number, rig = file.take("II")
        pose = np.array(file.take("7d"))
        data = [file.take("iIQ") for _ in range(file.one("I"))]
        model.frames[number] = (rig, pose, [(sensor, image) for _, sensor, image in data])
    assert file.at == len(file.data)
    file = Bytes(folder / "images.bin")
    for _ in range(file.one("Q")):
        number = file.one("I")
        pose, camera, name = np.array(file.take("7d")), file.one("I"), file.text()
        count = file.one("Q")
        rows = [file.take("ddQ") for _ in range(count)]
        model.images[number] = Image(pose, camera, name,
                                     np.array([row[:2] for row in rows]).reshape(-1, 2),
                                     np.array([row[2] for row in rows], dtype=np.uint64))
    assert file.at == len(file.data)
    file = Bytes(folder / "points3D.bin")
    for _ in range(file.one("Q")):
        number = file.one("Q")
        position, color, error = np.array(file.take("3d")), file.take("3B"), file.one("d")
        track = [file.take("II") for _ in range(file.one("Q"))]
        model.points[number] = (position, color, error, track)
    assert file.at == len(file.data)
    return model


def lines(path: Path) -> list[list[str]]:
    return [line.split() for line in path.read_text().splitlines() if not line.startswith("#")]


def read_text(folder: Path) -> Model:
    model = Model()
    for row in lines(folder / "cameras.txt"):
        model.cameras[int(row[0])] = (NAMES[row[1]], int(row[2]), int(row[3]),
                                      [float(word) for word in row[4:]])
    for row in lines(folder / "rigs.txt"):
        assert row[2] == "CAMERA"
        rig: dict[int, np.ndarray | None] = {int(row[3]): None}
        rest = row[4:]
        for _ in range(int(row[1]) - 1):
            assert (rest[0], rest[2]) == ("CAMERA", "1")
            rig[int(rest[1])] = np.array([float(word) for word in rest[3:10]])
            rest = rest[10:]
        assert rest == []
        model.rigs[int(row[0])] = rig
    for row in lines(folder / "frames.txt"):
        data = [(int(row[i + 1]), int(row[i + 2])) for i in range(10, len(row), 3)]
        assert len(data) == int(row[9])
        model.frames[int(row[0])] = (int(row[1]), np.array([float(w) for w in row[2:9]]), data)
    rows = lines(folder / "images.txt")
    for head, points in zip(rows[::2], rows[1::2]):
        table = np.array([float(word) for word in points]).reshape(-1, 3)
        ids = np.array([NO_POINT if i < 0 else i for i in table[:, 2].astype(int)], dtype=np.uint64)
        model.images[int(head[0])] = Image(np.array([float(word) for word in head[1:8]]),
                                           int(head[8]), head[9], table[:, :2], ids)
    for row in lines(folder / "points3D.txt"):
        track = [(int(row[i]), int(row[i + 1])) for i in range(8, len(row), 2)]
        model.points[int(row[0])] = (np.array([float(w) for w in row[1:4]]),
                                     tuple(int(w) for w in row[4:7]), float(row[7]), track)
    return model


def rotation(q: np.ndarray) -> np.ndarray:
    """The matrix of a quaternion w x y z."""
    w, x, y, z = q
    return np.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                     [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                     [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def project(camera: tuple[int, int, int, list[float]], points: np.ndarray) -> np.ndarray:
    """Pixels of points (n x 3) in the camera's frame: x right, y down, z forward."""
    kind, _, _, p = camera
    x, y, z = points.T
    if kind == EQUIRECTANGULAR:
        return np.stack([(np.arctan2(x, z) / (2 * np.pi) + 0.5) * p[0],
                         (0.5 - np.arctan2(-y, np.hypot(x, z)) / np.pi) * p[1]], axis=1)
    return np.stack([p[0] * x / z + p[2], p[1] * y / z + p[3]], axis=1)


def reprojection_errors(model: Model) -> np.ndarray:
    """The distance, pixels, of each pixel with a point from where that point appears."""
    errors = []
    for image in model.images.values():
        camera = model.cameras[image.camera]
        seen = image.points != NO_POINT
        if not seen.any():
            continue
        world = np.array([model.points[int(i)][0] for i in image.points[seen]])
        pixels = project(camera, world @ rotation(image.pose[:4]).T + image.pose[4:])
        difference = pixels - image.pixels[seen]
        if camera[0] == EQUIRECTANGULAR:
            width = camera[1]
            difference[:, 0] = (difference[:, 0] + width / 2) % width - width / 2
        errors.append(np.linalg.norm(difference, axis=1))
    return np.concatenate(errors)
