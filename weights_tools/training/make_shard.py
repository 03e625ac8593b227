"""Packs a rendered drive: python3 -m weights_tools.training.make_shard DRIVE SHARD.npz

DRIVE is a folder of `town render --masks`. Frames without depth (--depth-every) are left out. What
`orb360 run DRIVE --save-sparse` found there can be packed as well (--run): landmarks and ranges by stereo,
or with `--weights none` landmarks alone.
"""

import argparse
import contextlib
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import cv2
import h5py
import numpy as np
import yaml

from weights_tools.refusal import refusing
from weights_tools.training import shards
from weights_tools.training.ground import ground_pixels
from weights_tools.training.sphere import bearings

# The number of corners in an image with much texture; training uses a part of them. They are chosen
# from so many of the strongest: all that there are.
FEATURES, CANDIDATES = 6000, 100_000
# Bands of latitude and columns of cells, and the bands at which zones begin and the last one ends, as
# slam/features/corner_selection.h has them.
BANDS, COLUMNS, MAX_QUOTAS = 16, 32, 4
ZONES = (0, 4, 6, 8, 10, 12, 16)
# Scale from level to level of ORB's pyramid, and the standard deviation of a corner at its level.
SCALE, PIXELS = 1.2, 1.0
# Columns that are repeated at either side: OpenCV looks for no corner nearer than 31 pixels to the
# edge of a level, and the last of eight is 1.2^7 times as coarse.
MARGIN = 128


def read_drive(folder: Path, halvings: int = 0, run: Path | None = None) -> list[shards.Frame]:
    """Frames of a drive, each side halved so often, with the sparse depth of a run of SLAM."""
    constant_height = read_camera_height(folder / "sequence.yaml")
    poses = read_poses(folder / "groundtruth.txt")
    travels = travel_directions(poses[:, 1:4], poses[:, 4:8])
    ups = into_camera(np.tile([0.0, 0.0, 1.0], (len(poses), 1)), poses[:, 4:8])
    sparse = sparse_files(run) if run else {}
    frames = []
    for path in sorted((folder / "depth").glob("*.png")):
        if not path.stem.isdecimal() or int(path.stem) >= len(poses):
            raise ValueError(f"{path}: groundtruth.txt has no such frame; render the drive again")
        units = _read(path, cv2.IMREAD_UNCHANGED)
        if frames and units.shape != size:
            raise ValueError(f"{path}: has another size than frames before it; render the drive again")
        size = units.shape
        image = _read(folder / "rgb" / f"{path.stem}.jpg", cv2.IMREAD_COLOR, size)
        moving = _read(folder / "moving" / path.name, cv2.IMREAD_UNCHANGED, size)
        metres = units.astype(np.float32) / shards.RANGE_UNITS
        up = ups[int(path.stem)]
        camera_height = constant_height or height_below(metres, up)
        if not camera_height:
            continue
        frame = shards.Frame(
            image[:, :, ::-1],
            metres,
            moving > 0,
            ground_pixels(metres, up, camera_height),
            detect(image),
            travels[int(path.stem)],
            camera_height,
            read_points(sparse.get(int(path.stem)), metres),
        )
        for _ in range(halvings):
            frame = halved(frame)
        frames.append(frame)
    if not frames:
        raise ValueError(f"{folder}: has no depth; render it with `town render --masks`")
    return frames


def read_poses(path: Path) -> np.ndarray:
    """A row for each frame: time, position (metres), rotation world_from_camera (x y z w)."""
    lines = [line for line in path.read_text().splitlines() if line and not line.startswith("#")]
    try:
        poses = np.array([line.split() for line in lines], float)
    except ValueError:
        poses = np.zeros((0, 0))
    if poses.ndim != 2 or poses.shape[1] != 8:
        raise ValueError(f"{path}: has no poses of eight numbers; render the drive again")
    return poses


def read_camera_height(path: Path) -> float | None:
    """Height of the camera above the road, metres; None where it is not the same all along."""
    try:
        height = yaml.safe_load(path.read_text()).get("camera_height")
        return None if height is None else float(height)
    except (yaml.YAMLError, AttributeError, TypeError, ValueError) as error:
        raise ValueError(f"{path}: is no description of a drive; render it again") from error


def height_below(metres: np.ndarray, up: np.ndarray) -> float | None:
    """Metres to what is straight below the camera, where there is anything. `up` is the world's, in
    the frame of the camera."""
    height, width = metres.shape
    v, u = np.mgrid[0:height, 0:width] + 0.5
    down = -(bearings(u, v, height, width) @ up)
    below = (down > np.cos(np.radians(5))) & (metres > 0)
    return float(np.median((metres * down)[below])) if below.any() else None


def halved(frame: shards.Frame) -> shards.Frame:
    """The frame with half as many rows and columns."""
    height, width = frame.range.shape
    small = cv2.resize(frame.rgb, (width // 2, height // 2), interpolation=cv2.INTER_AREA)
    features, points = frame.features.copy(), frame.points.copy()
    features[:, :2] /= 2
    points[:, :2] //= 2
    return replace(
        frame,
        rgb=small,
        range=shrink_range(frame.range),
        moving=shrink_mask(frame.moving),
        ground=shrink_mask(frame.ground),
        features=features,
        points=points,
    )


def sparse_files(run: Path) -> dict[int, Path]:
    """Sparse points of a run's keyframes, by index of the frame."""
    files = {}
    for path in (run / "sparse").glob("*.h5"):
        with _sparse_file(path) as file:
            files[int(file.attrs["frame_index"])] = path
    if not files:
        raise ValueError(f"{run}: has no sparse depth; run orb360 with --save-sparse")
    return files


def read_points(path: Path | None, metres: np.ndarray) -> np.ndarray:
    """Row, column, metres and confidence of a keyframe's points on known surfaces. A map has a
    scale of its own: the points' median scale makes metres of it."""
    if path is None:
        return np.zeros((0, 4), np.float32)
    with _sparse_file(path) as file:
        ranges, confidence = file["range"][()], file["confidence"][()]
    if ranges.shape != metres.shape:
        raise ValueError(f"{path}: has another size than the drive, as with ranges by stereo of more than 1024 columns")
    rows, columns = np.nonzero((ranges > 0) & (metres > 0))
    ranges, truth = ranges[rows, columns], metres[rows, columns]
    metre = np.median(ranges / truth) if len(rows) else 1
    points = [rows, columns, ranges / metre, confidence[rows, columns]]
    return np.stack(points, axis=1).astype(np.float32)


@contextlib.contextmanager
def _sparse_file(path: Path) -> Iterator[h5py.File]:
    try:
        with h5py.File(path, "r") as file:
            yield file
    except (OSError, KeyError) as error:
        raise ValueError(f"{path}: is no sparse depth of orb360, or damaged") from error


def _read(path: Path, how: int, size: tuple[int, int] | None = None) -> np.ndarray:
    image = cv2.imread(str(path), how)
    if image is None:
        raise ValueError(f"{path}: cannot be read; render the drive with `town render --masks`")
    if size and image.shape[:2] != size:
        raise ValueError(f"{path}: has another size than the frame's depth; render the drive again")
    return image


def shrink_range(image: np.ndarray) -> np.ndarray:
    """The lower median of each square of 2 x 2: a number that is in the image, never one between
    a near and a far surface. 0 is taken to be infinitely far."""
    height, width = image.shape[0] // 2, image.shape[1] // 2
    squares = image[: 2 * height, : 2 * width].reshape(height, 2, width, 2).swapaxes(1, 2)
    squares = np.where(squares == 0, np.inf, squares).reshape(height, width, 4)
    median = np.sort(squares, axis=-1)[:, :, 1]
    return np.where(np.isinf(median), 0, median).astype(np.float32)


def shrink_mask(mask: np.ndarray) -> np.ndarray:
    """Halves a mask; a pixel is set where at least two of four are."""
    height, width = mask.shape[0] // 2, mask.shape[1] // 2
    return mask[: 2 * height, : 2 * width].reshape(height, 2, width, 2).sum(axis=(1, 3)) >= 2


def detect(image: np.ndarray) -> np.ndarray:
    """Corners spread as SLAM spreads them: u, v in pixels, standard deviation in radians."""
    height, width = image.shape[:2]
    wide = np.concatenate([image[:, -MARGIN:], image, image[:, :MARGIN]], axis=1)
    detector = cv2.ORB_create(CANDIDATES, scaleFactor=SCALE, fastThreshold=7)
    # OpenCV's first pixel has its centre at 0.
    found = [
        (corner.pt[0] + 0.5 - MARGIN, corner.pt[1] + 0.5, corner.octave, corner.response)
        for corner in detector.detect(wide)
    ]
    corners = np.array(found, np.float32).reshape(-1, 4)
    corners = corners[(corners[:, 0] >= 0) & (corners[:, 0] < width)]
    u, v, octave, response = corners.T
    chosen = select_corners(u / width, v / height, response, FEATURES)
    sigma = PIXELS * SCALE**octave * 2 * np.pi / width
    return np.stack([u, v, sigma], axis=1)[chosen].astype(np.float32)


def select_corners(x: np.ndarray, y: np.ndarray, response: np.ndarray, count: int) -> np.ndarray:
    """Indices of at most `count` corners by the rule of slam/features/corner_selection.h: each zone of
    latitude has its part of the solid angle, and no cell more than MAX_QUOTAS times its own; here for
    all levels together. x and y are fractions of the image's width and height. In the order of the
    corners."""
    band = np.minimum((y * BANDS).astype(int), BANDS - 1)
    cell = band * COLUMNS + np.minimum((x * COLUMNS).astype(int), COLUMNS - 1)
    borders = np.cos(np.pi * np.arange(BANDS + 1) / BANDS)
    fraction = (borders[:-1] - borders[1:]) / 2
    strongest = np.argsort(-response, kind="stable")
    ordered = strongest[np.argsort(cell[strongest], kind="stable")]  # by cell, then by strength
    first = np.searchsorted(cell[ordered], cell[ordered])
    rank = np.empty(len(cell), int)
    rank[ordered] = np.arange(len(cell)) - first
    quota = MAX_QUOTAS * count * fraction[band] / COLUMNS
    candidates = strongest[(rank < quota)[strongest]]
    zones = [
        candidates[(band[candidates] >= begin) & (band[candidates] < end)][
            : round(count * fraction[begin:end].sum())
        ]
        for begin, end in zip(ZONES, ZONES[1:])
    ]
    taken = np.concatenate(zones)
    rest = candidates[~np.isin(candidates, taken)]  # for what a zone lacks
    return np.sort(np.concatenate([taken, rest[: max(count - len(taken), 0)]]))


def travel_directions(positions: np.ndarray, quaternions: np.ndarray) -> np.ndarray:
    """Unit vectors in the camera's frame, from positions and rotations; zero where it stands."""
    motion = np.gradient(positions, axis=0) if len(positions) > 1 else np.zeros_like(positions)
    directions = into_camera(motion, quaternions)
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    standing = 1e-3  # metres from frame to frame
    return np.where(length > standing, directions / np.maximum(length, standing), 0)


def into_camera(vectors: np.ndarray, quaternions: np.ndarray) -> np.ndarray:
    """Vectors of the world in the camera's frame (-X forward, Y right, Z up), by rotations
    world_from_camera (x y z w; camera x right, y down, z forward)."""
    axis, w = quaternions[:, :3], quaternions[:, 3:]
    # v' = v + 2 w (v x a) + 2 (v x a) x a rotates by the conjugate.
    cross = np.cross(vectors, axis)
    right, down, forward = (vectors + 2 * w * cross + 2 * np.cross(cross, axis)).T
    return np.stack([-forward, right, -down], axis=1)


@refusing("make_shard")
def main() -> None:
    parser = argparse.ArgumentParser(description="Packs a rendered drive for training.")
    parser.add_argument("drive", type=Path, help="folder of `town render --masks`")
    parser.add_argument("out", type=Path, help="file to write (.npz)")
    parser.add_argument("--halvings", type=int, default=0, help="of the images' sides")
    parser.add_argument("--run", type=Path, help="folder of `orb360 run DRIVE --save-sparse`")
    arguments = parser.parse_args()
    frames = read_drive(arguments.drive, arguments.halvings, arguments.run)
    shards.write(arguments.out, shards.pack(frames))


if __name__ == "__main__":
    main()
