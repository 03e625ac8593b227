"""Trains the coarse network briefly with and without its parts, and prints what each gains:

    python3 -m weights_tools.training.ablate OUT --shards DRIVE.npz ... --validation OTHER.npz ...

Every variant starts from the same weights and sees the same images and points. With --start these are
those of a trained network: the table then tells how much of a part's gain the others can take over.
Otherwise only the first estimate was trained before. Training is short, so the table compares the
variants with each other; it does not tell what a released network would reach. Can be stopped at any
time, like training.
"""

import argparse
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import torch

from weights_tools.evaluation.evaluate_shards import evaluate
from weights_tools.refusal import refusing
from weights_tools.training.short_training import (
    NETWORK,
    add_options,
    settings_of,
    train_first_estimate,
)
from weights_tools.training.train import Settings, describe, train

# Each variant and the tensors that count nothing in it.
VARIANTS = {
    "complete": "",
    "without the image": "image",
    "without the latitude": "latitude level",
    "without the points beside their first estimate": "points.off",
    "without the first estimate (the points instead)": "propagated certainty trust",
    "first estimate as an input only": "trust",
    "without residual blocks": " ".join(
        f"encoder{level}_block{block}_second"
        for level, blocks in ((2, 1), (3, 1), (4, 2), (5, 2))
        for block in range(1, blocks + 1)
    ),
    "encoder of three levels": "lateral3.up",
    "upsampling by equal weights": "shares",
}
# Variants that have all parts, and what else is different in their training.
OTHER_TRAINING = {"normals as a second task": {"normals": 0.2}}
POINTS = ("300", "1000", "20000")
# The size of images for which products are counted.
HEIGHT, WIDTH = 256, 512


def products(zeroed: str) -> float:
    """Millions of multiply-accumulates of the layers that a result depends on."""
    description = describe(NETWORK, zeroed)
    needed = {port["tensor"] for port in description.graph.outputs}
    for node in reversed(description.graph.nodes):
        if needed.intersection(node.outputs) and not node.name.endswith(".zero"):
            needed.update(node.inputs)
    costs = description.multiply_accumulates(HEIGHT, WIDTH)
    return sum(cost for node, cost in costs.items() if node in needed) / 1e6


def ablate(
    out: Path,
    settings: Settings,
    shards: Sequence[Path],
    validation: Sequence[Path],
    start: Path | None = None,
    chosen: Sequence[str] = (),
) -> None:
    """Trains the chosen variants, or all, and prints a line for each. `start`: a network file or a
    checkpoint."""
    device = torch.device("cpu")
    starts = [start or train_first_estimate(out, settings, shards)]
    rows = []
    variants = {name: {"zeroed": zeroed} for name, zeroed in VARIANTS.items()} | OTHER_TRAINING
    for number, (name, changes) in enumerate(variants.items()):
        if chosen and name not in chosen:
            continue
        folder = out / f"variant{number}"
        network = train(replace(settings, **changes), folder, shards, [], device, starts).eval()
        errors: dict[str, list[float]] = {}
        for _, kind, measured in evaluate(network, validation, POINTS, 1):
            errors.setdefault(kind, []).extend(measured.absrel)
        means = [f"{np.mean(errors[kind]):.3f}" for kind in POINTS]
        rows.append("| " + " | ".join([name, *means, f"{products(changes.get('zeroed', '')):.0f}"]) + " |")
        print(rows[-1], flush=True)
    print("\n| | " + " | ".join(f"{count} points" for count in POINTS) + " | MMAC |")
    print("|---|" + "---:|" * (len(POINTS) + 1))
    print("\n".join(rows))


@refusing("ablate")
def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    add_options(parser, steps=1000)
    parser.add_argument("--start", type=Path, help="weights of all variants: file or checkpoint")
    parser.add_argument("--variants", nargs="+", default=[], choices=[*VARIANTS, *OTHER_TRAINING],
                        metavar="NAME", help="only these: %(choices)s")  # fmt: skip
    arguments = parser.parse_args()
    torch.set_num_threads(arguments.threads)
    settings = settings_of(arguments)
    paths = arguments.shards, arguments.validation
    ablate(arguments.out, settings, *paths, arguments.start, arguments.variants)


if __name__ == "__main__":
    main()
