"""Measures the released weights on worlds they were not trained on.

Renders each town with three mountings of the camera (its own height and level; 1 m high and 3 m
high, tilted by 5 degrees), draws sparse points as SLAM gives them (simulated: up to 3,000 as
landmarks, of which 5 % are wrong, more as ranges by stereo), completes them with `orb360 complete`
and compares with the rendered ranges up to 80 m, weighted by solid angle. Other worlds come from
packed drives (--shards) or from folders of images with depth (--folder DIR: rgb/NAME.jpg or .png,
depth/NAME.png with metres x 256, and points of a run in sparse/, which --points slam takes). The
headline figures are means over 500, 1,000 and 2,000 points. Drives are rendered once, into a cache
outside the repository.
"""

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cv2
import h5py
import numpy as np
import torch

from weights_tools import network_file
from weights_tools.evaluation import classical, visualization
from weights_tools.evaluation.depth_errors import RANGE_ENDS
from weights_tools.evaluation.evaluated_drives import (
    folder_frames,
    packed_frames,
    rendered_frames,
    town_specs,
)
from weights_tools.evaluation.given_points import SLAM, points_of
from weights_tools.evaluation.results import (
    ALONE,
    HEADLINE,
    OURS,
    PUBLISHED,
    Result,
    Scale,
    calibration_table,
)
from weights_tools.evaluation.tables import print_tables
from weights_tools.graph import Node
from weights_tools.training import shards
from weights_tools.training.make_dataset import ROOT, Programs
from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import SparsePoints
from weights_tools.training.sphere import row_weights
from weights_tools.training.validate import error_cut
from weights_tools.training.worlds import circuit_spec, kind_of

POINTS = ("300", "500", "1000", "2000", "10000", "100000")
SHOWN_POINTS = "1000"  # of the completions that images are written of


def write_sparse(path: Path, frame: Frame, points: SparsePoints) -> None:
    """Writes a keyframe in the format of `orb360 run --save-sparse`."""
    with h5py.File(path, "w") as file:
        file["image"] = frame.rgb
        file["range"], file["confidence"] = points.depth, points.confidence
        file.attrs["frame_index"] = np.int32(0)
        file.attrs["timestamp"] = 0.0
        file.attrs["world_from_camera"] = [0.0, 0, 0, 0, 0, 0, 1]


def propagation_of(weights: Path, out: Path) -> Path:
    """Writes a network file whose outputs are the first estimate of another network."""
    graph, own = network_file.read(weights)
    outputs = {"log_depth": "propagated", "confidence": "propagated.c", "scale": "points.median"}
    nodes = list(graph.nodes)
    if any("points.half" in node.outputs for node in nodes):  # it has half of the image's size
        for port in ("log_depth", "confidence"):
            name, given = f"alone.{port}", outputs[port]
            nodes.append(Node(name, "upsample_nearest", [given], [name], {}, {}))
            outputs[port] = name
    ports = [{"name": name, "tensor": tensor} for name, tensor in outputs.items()]
    dtype = next(iter(own.values())).dtype.type
    network_file.write(out, replace(graph, nodes=nodes, outputs=ports), own, dtype)
    return out


def complete(orb360: Path, weights: Path, sparse: Path, out: Path) -> dict[str, dict[str, Any]]:
    """Runs `orb360 complete --json`; gives its entries by the name of the sparse file."""
    command = [orb360, "complete", "--sparse", sparse, "--weights", weights, "--out", out, "--json"]
    done = subprocess.run([str(part) for part in command], check=True, stdout=subprocess.PIPE)
    return {Path(entry["sparse"]).stem: entry for entry in json.loads(done.stdout)}


def read_fraction(path: str) -> np.ndarray:
    return cv2.imread(path, cv2.IMREAD_UNCHANGED).astype(np.float32) / 65535


def read_depth(path: str) -> np.ndarray:
    """Ranges of a completed panorama, metres. It has one everywhere: what is farther away than the
    image can store, which it has as 0, is at the farthest range that it can."""
    units = cv2.imread(path, cv2.IMREAD_UNCHANGED)
    farthest = np.iinfo(units.dtype).max
    return np.where(units > 0, units, farthest).astype(np.float32) / shards.RANGE_UNITS


@dataclass(frozen=True)
class Evaluation:
    networks: dict[str, Path]  # methods and their weights
    orb360: Path
    points: Sequence[str]  # numbers of points, or SLAM
    shown: int  # frames of each drive that images are written of
    out: Path

    def drive(self, name: str, frames: Sequence[Frame]) -> Result:
        """Measures every frame with every number of points."""
        result = Result()
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            (folder / "sparse").mkdir()
            given = {}
            for i, frame in enumerate(frames):
                for kind in self.points:
                    points = points_of(frame, kind, i)
                    if points is not None:
                        given[f"{kind}-{i:03}"] = kind, i, points
            for key, (_, i, points) in given.items():
                write_sparse(folder / f"sparse/{key}.h5", frames[i], points)
            if not given:
                return result
            told = {
                method: complete(self.orb360, weights, folder / "sparse", folder / method)
                for method, weights in self.networks.items()
            }
            scales = {kind: Scale() for kind in self.points if kind in HEADLINE}
            for key, (kind, i, points) in given.items():
                self._frame(result, frames[i], points, kind, {m: told[m][key] for m in told})
                if kind in scales:
                    _add_scale(scales[kind], told[OURS][key], frames[i])
                if kind == SHOWN_POINTS and i < self.shown:
                    entry = told[OURS][key]
                    visualization.write_completion(
                        self.out / f"{name}-{i}.jpg",
                        frames[i],
                        points,
                        read_depth(entry["depth"]),
                        read_fraction(entry["confidence"]),
                    )
            result.scales += scales.values()
        return result

    def _frame(
        self,
        result: Result,
        frame: Frame,
        points: SparsePoints,
        kind: str,
        told: dict[str, dict[str, Any]],
    ) -> None:
        for method, entry in told.items():
            result.of(method, kind).add(frame.range, read_depth(entry["depth"]))
        truth = classical.thinned(frame.range)
        for method, interpolated in classical.METHODS.items():
            result.of(method, kind).add(truth, interpolated(frame, points))
        if kind in HEADLINE:
            depth, confidence = (
                read_depth(told[OURS]["depth"]),
                read_fraction(told[OURS]["confidence"]),
            )
            self._confidence(result, frame.range, depth, confidence)

    @staticmethod
    def _confidence(
        result: Result, truth: np.ndarray, depth: np.ndarray, confidence: np.ndarray
    ) -> None:
        known = (truth > 0) & (truth <= RANGE_ENDS[-1])
        weight = row_weights(len(truth))[:, None] * known
        relative = np.abs(depth - truth) / np.where(truth > 0, truth, 1)
        arrays = (relative, confidence, truth, weight)
        result.cuts.append(error_cut(*(torch.from_numpy(array) for array in arrays)))
        drawn = np.random.RandomState(0).choice(np.flatnonzero(known), 2000)
        expected = 1 / np.maximum(confidence.flat[drawn], 1e-4) - 1
        drawn_values = (expected, relative.flat[drawn], weight.flat[drawn])
        result.calibration.append(np.stack(drawn_values))


def _add_scale(scale: Scale, entry: dict[str, Any], frame: Frame) -> None:
    """Adds the errors of the metric scale. The input is in metres, so the true scale is 1."""
    for estimates, name in ((scale.plane, "camera_height"), (scale.guard, "camera_height_guess")):
        estimates.append(np.log(frame.camera_height / entry.get(name, np.nan)))


def build() -> None:
    subprocess.run([ROOT / "scripts/install_packages"], check=True, stdout=sys.stderr)
    configure = ["cmake", "--preset", "release"]
    subprocess.run(configure, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    programs = ["cmake", "--build", "--preset", "release", "--target", "orb360", "town"]
    subprocess.run(programs, cwd=ROOT, check=True, stdout=sys.stderr)


def town_name(text: str) -> str:
    """The name of a town. Refuses names that `town` does not know before anything is rendered."""
    if not re.fullmatch(r"Town[1-5]|Loop|[0-9]{1,18}", text):
        raise argparse.ArgumentTypeError(
            f"unknown town {text!r}: use Town1 ... Town5, Loop, or a seed of at most 18 digits"
        )
    return text


def existing(text: str) -> Path:
    if not Path(text).is_file():
        raise argparse.ArgumentTypeError(f"{text}: no such file")
    return Path(text)


def existing_folder(text: str) -> Path:
    if not Path(text).is_dir():
        raise argparse.ArgumentTypeError(f"{text}: no such folder")
    return Path(text)


def kind_of_points(text: str) -> str:
    if text != SLAM and not re.fullmatch(r"[1-9][0-9]{0,5}", text):
        raise argparse.ArgumentTypeError(f"{text!r} is neither a number of points nor {SLAM!r}")
    return text


def parse_arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("seed", nargs="?", type=town_name, help="a fresh town, besides the others")
    parser.add_argument("--quick", action="store_true", help="20 frames of each town, not 100")
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")
    towns = [f"Town{i}" for i in range(1, 6)]
    parser.add_argument("--towns", type=town_name, nargs="*", default=towns, help="[Town1 ... Town5]")
    parser.add_argument("--circuits", type=existing, nargs="*", default=[], metavar="MESH",
                        help="circuits of torcs-data (.acc); not part of `all`")  # fmt: skip
    parser.add_argument("--shards", type=existing, nargs="*", default=[], metavar="FILE",
                        help="drives that make_dataset has packed, by kind of world; part of `all`")  # fmt: skip
    parser.add_argument("--folder", type=existing_folder, nargs="*", default=[], metavar="DIR",
                        help="folders of images with depth; not part of `all`")  # fmt: skip
    parser.add_argument("--points", type=kind_of_points, nargs="+", default=POINTS,
                        help="numbers of points, or `slam` for those of a run [300 ... 100000]")  # fmt: skip
    weights = ROOT / "weights"
    parser.add_argument("--weights", type=existing, default=weights / "depth_completion.h5")
    parser.add_argument("--published", type=existing, default=weights / "encoder_decoder.h5")
    caches = Path(os.environ.get("XDG_CACHE_HOME", Path.home() / ".cache"))
    parser.add_argument("--cache", type=Path, default=caches / "orb360/depth",
                        help="folder for the rendered drives [%(default)s]")  # fmt: skip
    parser.add_argument("--out", type=Path, default=ROOT / "out/evaluate-depth",
                        help="folder for the images [out/evaluate-depth]")  # fmt: skip
    parser.add_argument("--build", type=Path, default=ROOT / "build", help="folder of the programs")
    parser.add_argument("--skip-build", action="store_true", help="use what is there")
    return parser.parse_args()


def main() -> int:
    arguments = parse_arguments()
    if not arguments.skip_build:
        build()
    arguments.out.mkdir(parents=True, exist_ok=True)
    programs = Programs(arguments.build / "town", arguments.build / "orb360")
    alone = propagation_of(arguments.weights, arguments.out / "propagation.h5")
    networks = {OURS: arguments.weights, ALONE: alone}
    if arguments.published.exists():
        networks[PUBLISHED] = arguments.published
    shown = 1 if arguments.quick else 3
    evaluation = Evaluation(networks, programs.orb360, arguments.points, shown, arguments.out)
    towns = [*arguments.towns, *([arguments.seed] if arguments.seed else [])]
    groups = {town: town_specs(town, arguments.quick) for town in towns}
    for mesh in arguments.circuits:
        groups[mesh.stem] = [circuit_spec(mesh, 20 if arguments.quick else 100, 1024)]
    drives = [
        (group, spec.name, lambda spec=spec: rendered_frames(spec, programs, arguments.cache))
        for group, specs in groups.items()
        for spec in specs
    ]
    drives += [
        (kind_of(path.stem), path.stem, lambda path=path: packed_frames(path))
        for path in arguments.shards
    ]
    drives += [
        (str(folder), folder.name, lambda folder=folder: folder_frames(folder))
        for folder in arguments.folder
    ]
    packed = {kind_of(path.stem) for path in arguments.shards}
    results: dict[str, Result] = {}
    total = Result()
    for group, name, frames in drives:
        print(f"completing {name}", file=sys.stderr)
        result = evaluation.drive(name, frames())
        results.setdefault(group, Result()).__iadd__(result)
        if group in (*towns, *packed):
            total += result
    visualization.write_calibration(arguments.out / "calibration.png", calibration_table(total))
    if arguments.json:
        summaries = {name: result.summary() for name, result in results.items()}
        summaries["all"] = total.summary()
        # NaN is no JSON.
        finite = {n: {k: v if v == v else None for k, v in s.items()} for n, s in summaries.items()}
        print(json.dumps(finite, indent=2))
    else:
        print_tables(results, total)
        print(f"\nThe images are in {arguments.out}.")
    return 0
