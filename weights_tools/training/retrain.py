"""Makes the released weights anew: python3 -m weights_tools.training.retrain OUT

Renders the drives, trains both networks in stages, draws their learning curves and writes
OUT/depth_completion.h5 and OUT/encoder_decoder.h5. Can be stopped at any time: the same command goes
on. Images of a quarter of the size come first: a step costs a sixteenth there, and what is learned
lasts.
"""

import argparse
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch

from weights_tools.export import export, trained
from weights_tools.refusal import refusing
from weights_tools.training import make_dataset, plot
from weights_tools.training.make_dataset import (
    FRAMES,
    SEEDS,
    TRACKED_FRAMES,
    WIDTH,
    Programs,
)
from weights_tools.training.train import Settings, train
from weights_tools.training.worlds import (
    file_specs,
    interior_spec,
    landscape_spec,
    require_for_training,
    town_spec,
    tunnel_spec,
)

INTERIORS, LANDSCAPES, TUNNELS = range(100, 200), range(100, 140), range(100, 140)
# Towns and other worlds for validation, and their frames, which are never used for training.
VALIDATION_SEEDS, VALIDATION_WORLDS, VALIDATION_FRAMES = range(2000, 2006), range(900, 906), 6
TRACKED_SEEDS = range(3000, 3008)  # their sparse points come from SLAM


@dataclass(frozen=True)
class Stage:
    """One training that begins where earlier stages ended."""

    name: str  # of its folder
    size: str  # of the shards
    settings: Settings
    starts: Sequence[str] = ()


_COMMON = Settings(
    warm_up=50, rate=1.5e-3, bfloat16=True, fixed_propagation=True, batch_normalization=True
)
_ALONE = Settings(batch=4, warm_up=20, rate=1e-2, decay=0, average=0.98)


def stages(factor: float) -> list[Stage]:
    """The stages in their order. `factor` multiplies the numbers of steps; with 1 they take two
    cores a night."""

    def steps(settings: Settings, network: str, count: int, batch: int) -> Settings:
        count = max(round(factor * count), 1)
        every = min(settings.checkpoint_every, count)
        return replace(settings, network=network, steps=count, batch=batch, checkpoint_every=every)

    ours, published = "coarse_depth_completion", "encoder_decoder"
    return [
        Stage("propagation", "half", steps(_ALONE, "propagation", 400, 4)),
        Stage("ours_quarter", "quarter", steps(_COMMON, ours, 20_000, 8), ["propagation"]),
        Stage("ours_half", "half", steps(_COMMON, ours, 20_000, 4), ["ours_quarter"]),
        Stage("ours_full", "full", steps(_COMMON, "depth_completion", 10_000, 2), ["ours_half"]),
        Stage("unguided", "quarter", steps(_ALONE, "unguided", 400, 4)),
        Stage("published_quarter", "quarter", steps(_COMMON, published, 5_000, 8), ["unguided"]),
        Stage("published_half", "half", steps(_COMMON, published, 5_000, 4), ["published_quarter"]),
    ]


# The file of a stage, and the expected relative error of ranges where the network's confidence does
# not state it. For the published network it is the mean error on unseen towns.
RELEASED = {
    "ours_full": ("depth_completion.h5", None),
    "published_half": ("encoder_decoder.h5", 0.13),
}


def render_all(
    out: Path,
    programs: Programs,
    circuits: Sequence[Path] = (),
    karts: Sequence[Path] = (),
    maps: Sequence[Path] = (),
) -> None:
    for path in (*circuits, *karts, *maps):
        require_for_training(path.stem)
    specs = [town_spec(seed, FRAMES, WIDTH) for seed in SEEDS]
    specs += [town_spec(seed, TRACKED_FRAMES, WIDTH, is_tracked=True) for seed in TRACKED_SEEDS]
    specs += [interior_spec(seed, FRAMES, WIDTH) for seed in INTERIORS]
    specs += [landscape_spec(seed, FRAMES, WIDTH) for seed in LANDSCAPES]
    specs += [tunnel_spec(seed, FRAMES, WIDTH) for seed in TUNNELS]
    specs += file_specs(circuits, karts, maps, FRAMES, WIDTH)
    make_dataset.make_all(specs, programs, out / "training")
    specs = [town_spec(seed, VALIDATION_FRAMES, WIDTH) for seed in VALIDATION_SEEDS]
    for spec_of in (interior_spec, landscape_spec, tunnel_spec):
        specs += [spec_of(seed, VALIDATION_FRAMES, WIDTH) for seed in VALIDATION_WORLDS]
    make_dataset.make_all(specs, programs, out / "validation")


def train_all(out: Path, shards: Path, factor: float, device: torch.device) -> None:
    for stage in stages(factor):
        paths = [sorted((shards / part / stage.size).glob("*.npz")) for part in ("training", "validation")]
        if not paths[0]:
            raise ValueError(f"{shards}: has no shards to train on")
        print(f"stage {stage.name}", flush=True)
        starts = [out / start / "checkpoint.pt" for start in stage.starts]
        train(stage.settings, out / stage.name, paths[0], paths[1], device, starts)


def release(out: Path) -> None:
    for stage, (name, log_error) in RELEASED.items():
        network, provenance, width = trained(out / stage / "checkpoint.pt")
        export(out / name, network, provenance, np.float16, width, log_error)
    for name in ("ours", "published"):
        folders = [out / f"{name}_{size}" for size in ("quarter", "half", "full")]
        folders = [folder for folder in folders if folder.exists()]
        plot.draw(out / f"learning_curve_{name}.png", folders)


@refusing("retrain")
def main() -> None:
    parser = argparse.ArgumentParser(description="Makes the released weights anew.")
    parser.add_argument("out", type=Path, help="folder for shards, checkpoints and weights")
    parser.add_argument("--steps", type=float, default=1.0, metavar="FACTOR",
                        help="on the numbers of steps (default: 1, a night on two cores)")  # fmt: skip
    make_dataset.add_files(parser)
    parser.add_argument("--device", default="cpu", help="as PyTorch names it (default: cpu)")
    root = Path(__file__).resolve().parent.parent.parent
    parser.add_argument("--build", type=Path, default=root / "build", help="folder of the programs")
    arguments = parser.parse_args()
    torch.set_num_threads(os.cpu_count() or 1)  # PyTorch itself takes half of them
    programs = Programs(arguments.build / "town", arguments.build / "orb360")
    shards = arguments.out / "shards"
    render_all(shards, programs, arguments.circuits, arguments.karts, arguments.maps)
    train_all(arguments.out, shards, arguments.steps, torch.device(arguments.device))
    release(arguments.out)


if __name__ == "__main__":
    main()
