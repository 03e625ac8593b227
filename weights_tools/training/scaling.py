"""Trains the coarse network with parts of the drives and draws its error on unseen ones over the steps:

    python3 -m weights_tools.training.scaling OUT --shards DRIVE.npz ... --validation OTHER.npz ...

Every training starts from the same weights and takes as many steps. More drives help where the
curves still lie apart at their ends, more steps where they still fall. Can be stopped at any time,
like training. Writes OUT/scaling.png.
"""

import argparse
import csv
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch

from weights_tools.evaluation.visualization import write_chart
from weights_tools.refusal import refusing
from weights_tools.training.short_training import add_options, settings_of, train_first_estimate
from weights_tools.training.train import Settings, train

# One drive of so many is used; the drives of each part are among those of the next.
PARTS = (8, 4, 2, 1)


def measure(
    out: Path, settings: Settings, shards: Sequence[Path], validation: Sequence[Path]
) -> dict[int, list[tuple[int, float, float]]]:
    """By number of drives: steps done, loss of the depth in training, error on unseen drives."""
    shards = sorted(shards)
    starts = [train_first_estimate(out, settings, shards[:: PARTS[0]])]
    curves = {}
    for part in PARTS:
        own = shards[::part]
        folder = out / f"drives{len(own)}"
        train(settings, folder, own, validation, torch.device("cpu"), starts)
        with (folder / "log.csv").open() as file:
            lines = {int(line["step"]): line for line in csv.DictReader(file)}
        curves[len(own)] = [
            (step, float(line["depth"]), float(line["unseen_absrel"]))
            for step, line in sorted(lines.items())
        ]
    return curves


def table(curves: dict[int, list[tuple[int, float, float]]]) -> list[str]:
    """A line for each number of drives, with the errors after each step that was measured."""
    steps = [step for step, *_ in next(iter(curves.values()))]
    lines = ["| drives | " + " | ".join(f"{step} steps" for step in steps) + " | loss in training |"]
    lines.append("|---:|" + "---:|" * (len(steps) + 1))
    for drives, curve in curves.items():
        errors = [f"{error:.3f}" for *_, error in curve]
        lines.append(f"| {drives} | " + " | ".join(errors) + f" | {curve[-1][1]:.3f} |")
    return lines


def draw(path: Path, curves: dict[int, list[tuple[int, float, float]]]) -> None:
    arrays = {
        f"{drives} drives": (np.array([step for step, *_ in curve]), np.array([e for *_, e in curve]))
        for drives, curve in curves.items()
    }
    write_chart(path, "step", "AbsRel on unseen drives", arrays, log_x=True)


@refusing("scaling")
def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add_options(parser, steps=2000)
    parser.add_argument("--every", type=int, default=250,
                        help="steps between measurements (default: %(default)s)")  # fmt: skip
    arguments = parser.parse_args()
    if len(arguments.shards) < PARTS[0]:
        raise ValueError(f"{len(arguments.shards)} drives are too few: give at least {PARTS[0]}")
    torch.set_num_threads(arguments.threads)
    settings = replace(settings_of(arguments), checkpoint_every=arguments.every)
    curves = measure(arguments.out, settings, arguments.shards, arguments.validation)
    print("\n" + "\n".join(table(curves)))
    draw(arguments.out / "scaling.png", curves)


if __name__ == "__main__":
    main()
