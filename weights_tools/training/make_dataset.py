"""Renders drives and packs them: python3 -m weights_tools.training.make_dataset --help

Can be stopped at any time: the same command goes on with the shards that are missing. Every drive is
drawn from its own number, so the first of many are those of few.
"""

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from weights_tools.refusal import refusing
from weights_tools.training import shards
from weights_tools.training.make_shard import halved, read_drive

ROOT = Path(__file__).resolve().parent.parent.parent
LIGHTS = ("noon", "morning", "sunset", "overcast")
SIZES = ("full", "half", "quarter")
# Towns to train on, frames of a drive, of one that SLAM tracks, and width in pixels.
SEEDS, FRAMES, TRACKED_FRAMES, WIDTH = range(1000, 1220), 24, 200, 1024
# Circuits reserved for measurements.
RESERVED = ("street-1", "aalborg")


class DriveError(Exception):
    """A drive that could not be rendered or tracked."""


@dataclass(frozen=True)
class Programs:
    town: Path
    orb360: Path


@dataclass(frozen=True)
class DriveSpec:
    """One drive: a town of a seed, or a circuit of torcs-data."""

    name: str  # of the shard
    options: Sequence[str]  # of `town render`, without the folder
    frames: int
    is_tracked: bool = False  # by SLAM; then only frames with points of its own are kept
    has_stereo: bool = False  # ranges by stereo are among these points
    circuit: Path | None = None
    path: Sequence[str] = field(default=())  # options of `town path`


def town_spec(
    seed: int, frames: int, width: int, is_tracked: bool = False, has_stereo: bool = False
) -> DriveSpec:
    """Draws light, traffic, height and tilt of the camera and sensor effects from the seed."""
    is_tracked = is_tracked or has_stereo
    random = np.random.RandomState([seed, is_tracked])
    options = ["--town", str(seed), "--light", LIGHTS[random.randint(len(LIGHTS))]]
    options += ["--traffic", f"{random.uniform():.2f}"]
    options += ["--camera-height", f"{random.uniform(0.8, 3):.3f}"]
    options += ["--camera-pitch", f"{random.uniform(-5, 5):.2f}"]
    options += ["--camera-roll", f"{random.uniform(-5, 5):.2f}"]
    options += _sensor(random)
    # A frame each second when there is no tracking: some ten metres from one to the next.
    options += ["--fps", "20" if is_tracked else "1", "--width", str(width)]
    kind = "stereo" if has_stereo else "tracked" if is_tracked else "town"
    return DriveSpec(f"{kind}{seed}", options, frames, is_tracked, has_stereo)


def circuit_spec(mesh: Path, frames: int, width: int) -> DriveSpec:
    if mesh.stem in RESERVED:
        raise ValueError(f"{mesh}: is kept for other measurements; leave it out")
    random = np.random.RandomState([ord(letter) for letter in mesh.stem])
    options = ["--light", LIGHTS[random.randint(len(LIGHTS))], *_sensor(random)]
    options += ["--fps", "1", "--width", str(width)]
    path = ["--height", f"{random.uniform(0.8, 3):.3f}", "--speed", f"{random.uniform(15, 30):.1f}"]
    return DriveSpec(mesh.stem, options, frames, circuit=mesh, path=path)


def _sensor(random: np.random.RandomState) -> list[str]:
    options = []
    for option, probability in (("--auto-exposure", 0.5), ("--noise", 0.3), ("--dual-lens", 0.2)):
        if random.uniform() < probability:
            options.append(option)
    if random.uniform() < 0.3:
        options += ["--jpeg-quality", str(random.randint(40, 95))]
    return options


def make(spec: DriveSpec, programs: Programs, out: Path) -> None:
    """Writes OUT/full/NAME.npz, and the same with sides of a half and of a quarter."""
    paths = [out / size / f"{spec.name}.npz" for size in SIZES]
    if all(path.exists() for path in paths):
        return
    with tempfile.TemporaryDirectory(dir=out) as folder:
        frames = render(spec, programs, Path(folder))
    for path in paths:
        path.parent.mkdir(parents=True, exist_ok=True)
        shards.write(path, shards.pack(frames))
        frames = [halved(frame) for frame in frames]


def make_all(specs: Sequence[DriveSpec], programs: Programs, out: Path) -> int:
    """Makes all drives. Returns how many could be made, and prints which could not and why."""
    out.mkdir(parents=True, exist_ok=True)
    made = 0
    for i, spec in enumerate(specs, 1):
        problem = ""
        try:
            make(spec, programs, out)
            made += 1
        except DriveError as error:
            problem = f" left out: {error}"
        print(f"{i} of {len(specs)}: {spec.name}{problem}", flush=True)
    return made


def render(spec: DriveSpec, programs: Programs, folder: Path) -> list[shards.Frame]:
    """The frames that have a depth, and of a tracked drive points. Leaves files in the folder."""
    drive, run = folder / "drive", folder / "run"
    where = []
    if spec.circuit:
        line = folder / "path.txt"
        _call([programs.town, "path", "--torcs", spec.circuit, "--out", line, *spec.path])
        where = ["--scene", str(spec.circuit), "--path", str(line)]
    frames = ["--frames", str(spec.frames)]
    _call([programs.town, "render", *where, *spec.options, *frames, "--masks", "--out", drive])
    if not spec.is_tracked:
        return read_drive(drive)
    weights = [] if spec.has_stereo else ["--weights", "none"]
    _call([programs.orb360, "run", drive, *weights, "--mask", "none",
           "--save-sparse", "--out", run])  # fmt: skip
    return [frame for frame in read_drive(drive, run=run) if len(frame.points) > 0]


def _call(command: Sequence[object]) -> None:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise DriveError(f"{command[0]} failed: {done.stderr.strip()}")


@refusing("make_dataset")
def main() -> int:
    parser = argparse.ArgumentParser(description="Renders drives and packs them for training.")
    parser.add_argument("out", type=Path, help="folder for full/, half/ and quarter/ with the shards")
    parser.add_argument("--seeds", type=int, nargs=2, default=(SEEDS.start, SEEDS.stop),
                        metavar=("FIRST", "END"))  # fmt: skip
    parser.add_argument("--frames", type=int, default=FRAMES, help="of a drive (default: %(default)s)")
    parser.add_argument("--width", type=int, default=WIDTH, help="of the images (default: %(default)s)")
    parser.add_argument("--tracked-seeds", type=int, nargs="*", default=[],
                        help="towns that SLAM tracks, for landmarks as points")  # fmt: skip
    parser.add_argument("--stereo-seeds", type=int, nargs="*", default=[],
                        help="towns that SLAM tracks, for landmarks and ranges by stereo as points")
    parser.add_argument("--tracked-frames", type=int, default=TRACKED_FRAMES,
                        help="of these (default: %(default)s)")
    parser.add_argument("--circuits", type=Path, nargs="*", default=[],
                        help="meshes (.acc) of circuits of torcs-data")  # fmt: skip
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="folder of the programs")
    arguments = parser.parse_args()
    programs = Programs(arguments.build / "town", arguments.build / "orb360")
    frames, width = arguments.frames, arguments.width
    specs = [circuit_spec(mesh, frames, width) for mesh in arguments.circuits]
    specs += [town_spec(seed, frames, width) for seed in range(*arguments.seeds)]
    for seed in arguments.tracked_seeds:
        specs.append(town_spec(seed, arguments.tracked_frames, width, is_tracked=True))
    for seed in arguments.stereo_seeds:
        specs.append(town_spec(seed, arguments.tracked_frames, width, has_stereo=True))
    made = make_all(specs, programs, arguments.out)
    return 0 if made or not specs else 1


if __name__ == "__main__":
    sys.exit(main())
