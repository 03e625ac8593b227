"""Packs a rendered drive: python3 -m weights_tools.training.make_shard DRIVE SHARD.npz

DRIVE is a folder of `town render --masks`. Frames without depth (--depth-every) are left out. What
`orb360 run DRIVE --save-sparse` found there can be packed as well (--run).
"""

import argparse
from pathlib import Path

import cv2
import h5py
import numpy as np
import yaml

from weights_tools.training import shards

# As many as a crowded picture has; training takes a part of them.
FEATURES = 6000
# Scale from level to level of ORB's pyramid, and the standard deviation of a corner at its level.
SCALE, PIXELS = 1.2, 1.0
# Columns that are repeated at either side: OpenCV looks for no corner nearer than 31 pixels to the
# edge of a level, and the last of eight is 1.2^7 times as coarse.
MARGIN = 128


def read_drive(folder: Path, halvings: int = 0, run: Path | None = None) -> list[shards.Frame]:
    """Frames of a drive, each side halved so often, with the sparse depth of a run of SLAM."""
    description = yaml.safe_load((folder / "sequence.yaml").read_text())
    poses = np.loadtxt(folder / "groundtruth.txt", ndmin=2)
    travels = travel_directions(poses[:, 1:4], poses[:, 4:8])
    sparse = sparse_files(run) if run else {}
    frames = []
    for path in sorted((folder / "depth").glob("*.png")):
        picture = _read(folder / "rgb" / f"{path.stem}.jpg", cv2.IMREAD_COLOR)
        moving = _read(folder / "moving" / path.name, cv2.IMREAD_UNCHANGED)
        metres = _read(path, cv2.IMREAD_UNCHANGED).astype(np.float32) / shards.RANGE_UNITS
        factor = 2**halvings
        height, width = metres.shape[0] // factor, metres.shape[1] // factor
        features = detect(picture)
        features[:, :2] /= factor
        frames.append(
            shards.Frame(
                cv2.resize(picture, (width, height), interpolation=cv2.INTER_AREA)[:, :, ::-1],
                shrink_range(metres, factor),
                shrink_range(moving.astype(np.float32), factor) > 0,
                features,
                travels[int(path.stem)],
                float(description["camera_height"]),
                read_points(sparse.get(int(path.stem)), metres, factor),
            )
        )
    if not frames:
        raise ValueError(f"{folder}: has no depth; render it with `town render --masks`")
    return frames


def sparse_files(run: Path) -> dict[int, Path]:
    """Of a run's keyframes, by frame."""
    files = {}
    for path in (run / "sparse").glob("*.h5"):
        with h5py.File(path, "r") as file:
            files[int(file.attrs["frame_index"])] = path
    if not files:
        raise ValueError(f"{run}: has no sparse depth; run orb360 with --save-sparse")
    return files


def read_points(path: Path | None, metres: np.ndarray, factor: int) -> np.ndarray:
    """Row, column, metres and confidence of a keyframe's points on known surfaces. A map has a
    scale of its own: the points' median scale makes metres of it."""
    if path is None:
        return np.zeros((0, 4), np.float32)
    with h5py.File(path, "r") as file:
        ranges, confidence = file["range"][()], file["confidence"][()]
    if ranges.shape != metres.shape:
        raise ValueError(f"{path}: has another size than the drive; run orb360 without --resize")
    rows, columns = np.nonzero((ranges > 0) & (metres > 0))
    ranges, truth = ranges[rows, columns], metres[rows, columns]
    metre = np.median(ranges / truth) if len(rows) else 1
    points = [rows // factor, columns // factor, ranges / metre, confidence[rows, columns]]
    return np.stack(points, axis=1).astype(np.float32)


def _read(path: Path, how: int) -> np.ndarray:
    picture = cv2.imread(str(path), how)
    if picture is None:
        raise ValueError(f"{path}: cannot be read; render the drive with `town render --masks`")
    return picture


def shrink_range(picture: np.ndarray, factor: int) -> np.ndarray:
    """The lower median of each square: a number that is in the picture, never one between a near
    and a far surface. 0 is taken to be infinitely far."""
    height, width = picture.shape[0] // factor, picture.shape[1] // factor
    squares = picture[: height * factor, : width * factor]
    squares = squares.reshape(height, factor, width, factor).swapaxes(1, 2)
    sorted_ = np.sort(np.where(squares == 0, np.inf, squares).reshape(height, width, -1), axis=-1)
    median = sorted_[:, :, (factor * factor - 1) // 2]
    return np.where(np.isinf(median), 0, median).astype(np.float32)


def detect(picture: np.ndarray) -> np.ndarray:
    """Corners as SLAM finds them: u, v in pixels, standard deviation in radians."""
    width = picture.shape[1]
    wide = np.concatenate([picture[:, -MARGIN:], picture, picture[:, :MARGIN]], axis=1)
    detector = cv2.ORB_create(FEATURES, scaleFactor=SCALE, fastThreshold=7)
    features = []
    for corner in detector.detect(wide):
        # OpenCV's first pixel has its centre at 0.
        u, v = corner.pt[0] + 0.5 - MARGIN, corner.pt[1] + 0.5
        if 0 <= u < width:
            features.append((u, v, PIXELS * SCALE**corner.octave * 2 * np.pi / width))
    return np.array(features, np.float32).reshape(-1, 3)


def travel_directions(positions: np.ndarray, quaternions: np.ndarray) -> np.ndarray:
    """Unit vectors in the camera's frame (-X forward, Y right, Z up), from positions and rotations
    world_from_camera (x y z w; camera x right, y down, z forward); zero where it stands."""
    motion = np.gradient(positions, axis=0) if len(positions) > 1 else np.zeros_like(positions)
    axis, w = quaternions[:, :3], quaternions[:, 3:]
    # v' = v + 2 w (v x a) + 2 (v x a) x a rotates by the conjugate.
    cross = np.cross(motion, axis)
    right, down, forward = (motion + 2 * w * cross + 2 * np.cross(cross, axis)).T
    directions = np.stack([-forward, right, -down], axis=1)
    length = np.linalg.norm(directions, axis=1, keepdims=True)
    standing = 1e-3  # metres from frame to frame
    return np.where(length > standing, directions / np.maximum(length, standing), 0)


def main() -> None:
    parser = argparse.ArgumentParser(description="Packs a rendered drive for training.")
    parser.add_argument("drive", type=Path, help="folder of `town render --masks`")
    parser.add_argument("out", type=Path, help="file to write (.npz)")
    parser.add_argument("--halvings", type=int, default=0, help="of the pictures' sides")
    parser.add_argument("--run", type=Path, help="folder of `orb360 run DRIVE --save-sparse`")
    arguments = parser.parse_args()
    frames = read_drive(arguments.drive, arguments.halvings, arguments.run)
    shards.write(arguments.out, shards.pack(frames))


if __name__ == "__main__":
    main()
