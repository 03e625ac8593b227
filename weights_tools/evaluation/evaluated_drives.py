"""The frames that networks are measured on."""

import hashlib
import sys
import tempfile
from pathlib import Path

import cv2
import numpy as np

from weights_tools.training import shards
from weights_tools.training.make_dataset import ROOT, Programs, render
from weights_tools.training.make_shard import detect, read_points, sparse_files
from weights_tools.training.shards import Frame
from weights_tools.training.worlds import DriveSpec

# Height (None: the town's own), pitch, roll; and how many of a town's frames have it.
MOUNTINGS = ((None, 0, 0, 8), (1.0, 5, -3, 6), (3.0, -4, 5, 6))
# One frame every five seconds of the drive, with --quick; otherwise each second.
QUICK_EVERY = 5
IMAGES = (".jpg", ".jpeg", ".png")


def town_specs(town: str, is_quick: bool) -> list[DriveSpec]:
    specs = []
    for i, (height, pitch, roll, frames) in enumerate(MOUNTINGS):
        options = ["--town", town, "--fps", "1", "--width", "1024"]
        options += ["--camera-pitch", str(pitch), "--camera-roll", str(roll)]
        if height:
            options += ["--camera-height", str(height)]
        if is_quick:
            options += ["--depth-every", str(QUICK_EVERY)]
        specs.append(DriveSpec(f"{town}-{i}", options, frames * QUICK_EVERY))
    return specs


def rendered_frames(spec: DriveSpec, programs: Programs, cache: Path) -> list[Frame]:
    """The frames of a drive, rendered unless the cache has them."""
    key = repr((spec.options, spec.frames, spec.path, renderer_fingerprint())).encode()
    path = cache / f"{spec.name}-{hashlib.sha256(key).hexdigest()[:8]}.npz"
    if not path.exists():
        print(f"rendering {spec.name}", file=sys.stderr)
        cache.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=cache) as folder:
            shards.write(path, shards.pack(render(spec, programs, Path(folder))))
    return packed_frames(path)


def packed_frames(path: Path) -> list[Frame]:
    shard = shards.read(path)
    return [shard.frame(i) for i in range(len(shard))]


def folder_frames(folder: Path) -> list[Frame]:
    """Frames of a folder that anyone can make: rgb/NAME.jpg or .png, equirectangular, and
    depth/NAME.png (16 bit, metres = value / 256, 0 where there is none), of 1024 x 512 pixels or any
    other size. With sparse/*.h5, as `orb360 run --save-sparse` writes them, the frames also have the
    points of that run."""
    images = {p.stem: p for p in sorted((folder / "rgb").glob("*")) if p.suffix.lower() in IMAGES}
    depths = sorted((folder / "depth").glob("*.png"))
    if not depths:
        raise ValueError(f"{folder}: has no depth/*.png (16 bit, metres = value / 256)")
    sparse = sparse_files(folder) if (folder / "sparse").exists() else {}
    frames = []
    for path in depths:
        units = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        if units is None or units.dtype != np.uint16 or units.ndim != 2:
            raise ValueError(f"{path}: is no image with one channel of 16 bits")
        if path.stem not in images:
            raise ValueError(f"{path}: has no image of its name in {folder / 'rgb'}")
        image = cv2.imread(str(images[path.stem]), cv2.IMREAD_COLOR)
        if image is None or image.shape[:2] != units.shape:
            raise ValueError(f"{images[path.stem]}: cannot be read, or has another size than {path}")
        metres = units.astype(np.float32) / shards.RANGE_UNITS
        index = int(path.stem) if path.stem.isdecimal() else -1
        nowhere = np.zeros(units.shape, bool)
        frames.append(
            Frame(
                image[:, :, ::-1],
                metres,
                nowhere,
                nowhere,
                detect(image),
                np.zeros(3, np.float32),  # the direction of travel is not known
                float("nan"),
                read_points(sparse.get(index), metres),
            )
        )
    return frames


def renderer_fingerprint() -> str:
    """A digest of the renderer's source, so that no stale drive is used."""
    digest = hashlib.sha256()
    for folder in ("apps/town", "include/orb360/slam/geometry", "slam/geometry"):
        for path in sorted((ROOT / folder).rglob("*")):
            if path.suffix in (".h", ".cc"):
                digest.update(str(path.relative_to(ROOT)).encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()
