"""A drive that a renderer could have written, with ranges in closed form."""

from pathlib import Path

import cv2
import h5py
import numpy as np

from weights_tools.training.shards import Frame
from weights_tools.training.sphere import bearings

HEIGHT, WIDTH = 64, 128
CAMERA_HEIGHT = 1.5  # metres
WALL = 8.0  # metres to the left and right


def street() -> np.ndarray:
    """Range over a road between two long walls 6 m high, under the sky."""
    u, v = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    _, right, up = np.moveaxis(bearings(u, v, HEIGHT, WIDTH), -1, 0)
    with np.errstate(divide="ignore"):
        to_wall = WALL / np.abs(right)
        to_ground = np.where(up < 0, CAMERA_HEIGHT / -up, np.inf)
    nearest = np.minimum(to_wall, to_ground)
    over_the_wall = (up > 0) & (to_wall * up > 6 - CAMERA_HEIGHT)
    return np.where(over_the_wall | (nearest > 200), 0, nearest).astype(np.float32)


def frame(seed: int = 0) -> Frame:
    """A frame with features everywhere below the sky, of a camera that moves forward."""
    random = np.random.RandomState(seed)
    count = 4000
    features = np.stack(
        [
            random.uniform(0, WIDTH, count),
            random.uniform(0, HEIGHT, count),
            np.full(count, 2 * np.pi / 1024),
        ],
        axis=1,
    ).astype(np.float32)
    rgb = random.randint(0, 256, (HEIGHT, WIDTH, 3)).astype(np.uint8)
    travel = np.array([-1.0, 0.0, 0.0], np.float32)
    still = np.zeros((HEIGHT, WIDTH), bool)
    none = np.zeros((0, 4), np.float32)
    return Frame(rgb, street(), still, road(), features, travel, CAMERA_HEIGHT, none)


def road() -> np.ndarray:
    u, v = np.meshgrid(np.arange(WIDTH) + 0.5, np.arange(HEIGHT) + 0.5)
    height = street() * bearings(u, v, HEIGHT, WIDTH)[..., 2]
    return (street() > 0) & (np.abs(height + CAMERA_HEIGHT) < 1e-3)


def write_run(folder: Path, metre: float = 0.25) -> None:
    """Exact sparse depth of frame 2 at every eighth pixel, in units of the map."""
    (folder / "sparse").mkdir(parents=True)
    ranges = np.zeros((HEIGHT, WIDTH), np.float32)
    ranges[::8, ::8] = metre * street()[::8, ::8]
    with h5py.File(folder / "sparse/000002.h5", "w") as file:
        file["range"] = ranges
        file["confidence"] = np.where(ranges > 0, 0.75, 0).astype(np.float32)
        file.attrs["frame_index"] = 2


def write_drive(folder: Path, frames: int = 3, depth_every: int = 2) -> None:
    """The camera drives along world +x, one metre from frame to frame, looking to world +y."""
    for name in ("rgb", "depth", "moving"):
        (folder / name).mkdir(parents=True)
    (folder / "sequence.yaml").write_text(f"camera_height: {CAMERA_HEIGHT}  # metres\n")
    # x right = world +x, y down = world -z, z forward = world +y: a quarter turn about x.
    half = np.sqrt(0.5)
    lines = [f"{i} {i} 0 0 {-half} 0 0 {half}\n" for i in range(frames)]
    (folder / "groundtruth.txt").write_text("# a comment\n" + "".join(lines))
    random = np.random.RandomState(0)
    blocks = random.randint(0, 256, (HEIGHT // 8, WIDTH // 8, 3)).astype(np.uint8)
    for i in range(frames):
        image = np.kron(blocks, np.ones((8, 8, 1), np.uint8))
        cv2.imwrite(str(folder / f"rgb/{i:06}.jpg"), image)
        if i % depth_every == 0:
            metres = np.rint(street() * 256).astype(np.uint16)
            cv2.imwrite(str(folder / f"depth/{i:06}.png"), metres)
            moving = np.zeros((HEIGHT, WIDTH), np.uint8)
            moving[40:48, 100:128] = 255
            cv2.imwrite(str(folder / f"moving/{i:06}.png"), moving)
