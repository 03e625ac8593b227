"""Renders drives and packs them: python3 -m weights_tools.training.make_dataset --help

Can be stopped at any time: the same command goes on with the shards that are missing. Every drive is
drawn from its own number, so the first of many are those of few.
"""

import argparse
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from weights_tools.refusal import refusing
from weights_tools.training import shards
from weights_tools.training.make_shard import halved, read_drive
from weights_tools.training.worlds import (
    DriveSpec,
    file_specs,
    interior_spec,
    landscape_spec,
    require_for_training,
    town_spec,
    tracked,
    tunnel_spec,
)

ROOT = Path(__file__).resolve().parent.parent.parent
SIZES = ("full", "half", "quarter")
# Towns to train on, frames of a drive, of one that SLAM tracks, and width in pixels.
SEEDS, FRAMES, TRACKED_FRAMES, WIDTH = range(1000, 1220), 24, 200, 1024
SPEED = 5.0  # metres a second, of worlds other than towns where SLAM tracks


class DriveError(Exception):
    """A drive that could not be rendered or tracked."""


@dataclass(frozen=True)
class Programs:
    town: Path
    orb360: Path


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
    if spec.path:
        line = folder / "path.txt"
        _call([programs.town, "path", *spec.path, "--out", line])
        where = ["--path", str(line)]
    frames = ["--frames", str(spec.frames)]
    _call([programs.town, "render", *spec.options, *where, *frames, "--masks", "--out", drive])
    if not spec.is_tracked:
        return _packable(drive, None)
    weights = [] if spec.has_stereo else ["--weights", "none"]
    _call([programs.orb360, "run", drive, *weights, "--mask", "none",
           "--save-sparse", "--out", run])  # fmt: skip
    frames = [frame for frame in _packable(drive, run) if len(frame.points) > 0]
    if not frames:
        raise DriveError("SLAM found no points in its frames with depth")
    return frames


def _packable(drive: Path, run: Path | None) -> list[shards.Frame]:
    try:
        return read_drive(drive, run=run)
    except ValueError as error:
        raise DriveError(str(error)) from error


def _call(command: Sequence[object]) -> None:
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True)
    if done.returncode != 0:
        raise DriveError(f"{command[0]} failed: {done.stderr.strip()}")


def add_files(parser: argparse.ArgumentParser) -> None:
    """The options that name worlds by their files."""
    parser.add_argument("--circuits", type=Path, nargs="*", default=[],
                        help="meshes (.acc) of circuits of torcs-data")  # fmt: skip
    parser.add_argument("--karts", type=Path, nargs="*", default=[],
                        help="folders of tracks of supertuxkart-data")  # fmt: skip
    parser.add_argument("--maps", type=Path, nargs="*", default=[],
                        help="maps (.bsp) of Quake 3 in the game's folder")  # fmt: skip


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
    add_files(parser)
    parser.add_argument("--walks", type=int, nargs=2, default=(0, 1), metavar=("FIRST", "END"),
                        help="through each of these maps (default: one)")  # fmt: skip
    parser.add_argument("--interiors", type=int, nargs=2, default=(0, 0), metavar=("FIRST", "END"))
    parser.add_argument("--landscapes", type=int, nargs=2, default=(0, 0), metavar=("FIRST", "END"))
    parser.add_argument("--tunnels", type=int, nargs=2, default=(0, 0), metavar=("FIRST", "END"))
    parser.add_argument("--stereo-worlds", action="store_true",
                        help="SLAM also tracks all of these worlds but the towns")  # fmt: skip
    parser.add_argument("--held-out", action="store_true",
                        help="worlds that are kept for measurements are allowed")  # fmt: skip
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="folder of the programs")
    arguments = parser.parse_args()
    programs = Programs(arguments.build / "town", arguments.build / "orb360")
    frames, width = arguments.frames, arguments.width
    if not arguments.held_out:
        for path in (*arguments.circuits, *arguments.karts, *arguments.maps):
            require_for_training(path.stem)
    files = (arguments.circuits, arguments.karts, arguments.maps)
    specs = file_specs(*files, frames, width, range(*arguments.walks))
    specs += [interior_spec(seed, frames, width) for seed in range(*arguments.interiors)]
    specs += [landscape_spec(seed, frames, width) for seed in range(*arguments.landscapes)]
    specs += [tunnel_spec(seed, frames, width) for seed in range(*arguments.tunnels)]
    if arguments.stereo_worlds:
        specs += [tracked(spec, arguments.tracked_frames, SPEED) for spec in specs]
    specs += [town_spec(seed, frames, width) for seed in range(*arguments.seeds)]
    for seed in arguments.tracked_seeds:
        specs.append(town_spec(seed, arguments.tracked_frames, width, is_tracked=True))
    for seed in arguments.stereo_seeds:
        specs.append(town_spec(seed, arguments.tracked_frames, width, has_stereo=True))
    made = make_all(specs, programs, arguments.out)
    return 0 if made or not specs else 1


if __name__ == "__main__":
    sys.exit(main())
