"""Short trainings of the coarse network from one start, to compare networks or amounts of data."""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import torch

from weights_tools.training.train import Settings, train

NETWORK = "coarse_depth_completion"
_FIRST = Settings(network="propagation", steps=200, warm_up=20, rate=1e-2, decay=0, average=0.98)


def train_first_estimate(out: Path, settings: Settings, shards: Sequence[Path]) -> Path:
    """Trains the normalized convolutions of the first estimate alone; gives the checkpoint that the
    trainings to be compared start from, with that part fixed."""
    first = replace(_FIRST, steps=min(_FIRST.steps, settings.steps), bfloat16=settings.bfloat16)
    train(first, out / "propagation", shards, [], torch.device("cpu"))
    return out / "propagation" / "checkpoint.pt"


def add_options(parser: argparse.ArgumentParser, steps: int) -> None:
    parser.add_argument("out", type=Path, help="folder for the trainings")
    parser.add_argument("--shards", type=Path, nargs="+", required=True, help="to train on")
    parser.add_argument("--validation", type=Path, nargs="+", required=True, help="to measure on")
    parser.add_argument("--steps", type=int, default=steps, help="(default: %(default)s)")
    parser.add_argument("--batch", type=int, default=8, help="(default: %(default)s)")
    parser.add_argument("--rate", type=float, default=1.5e-3, help="(default: %(default)s)")
    parser.add_argument("--threads", type=int, default=torch.get_num_threads())
    parser.add_argument("--bfloat16", action="store_true")


def settings_of(arguments: argparse.Namespace) -> Settings:
    """The settings that the options ask for."""
    return Settings(
        network=NETWORK, steps=arguments.steps, batch=arguments.batch, rate=arguments.rate,
        warm_up=50, average=0.99, fixed_propagation=True, batch_normalization=True,
        bfloat16=arguments.bfloat16,
    )  # fmt: skip
