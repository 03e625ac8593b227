"""Draws learning curves: python3 -m weights_tools.training.plot OUT.png DIR ..."""

import argparse
import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from weights_tools.evaluation.visualization import write_chart
from weights_tools.refusal import refusing

COLUMNS = ("depth", "unseen_absrel", "unseen_scale_error")


def draw(out: Path, folders: Sequence[Path]) -> None:
    """Reads the logs of several stages and joins them in their order."""
    curves: dict[str, tuple[list[float], list[float]]] = {}
    first = 0
    for folder in folders:
        path = folder / "log.csv"
        with path.open() as file:
            lines = list(csv.DictReader(file))
        if not all("step" in line for line in lines):
            raise ValueError(f"{path}: is no log of a training: it has no steps")
        for line in lines:
            for name in COLUMNS:
                if name in line:
                    steps, values = curves.setdefault(name, ([], []))
                    steps.append(first + int(line["step"]))
                    values.append(float(line[name]))
        first += int(lines[-1]["step"]) if lines else 0
    arrays = {name: (np.array(x), np.array(y)) for name, (x, y) in curves.items()}
    write_chart(out, "step", "error", arrays)


@refusing("plot")
def main() -> None:
    parser = argparse.ArgumentParser(description="Draws learning curves.")
    parser.add_argument("out", type=Path, help="image to write (.png)")
    parser.add_argument("folders", type=Path, nargs="+", help="stages, in their order")
    arguments = parser.parse_args()
    draw(arguments.out, arguments.folders)


if __name__ == "__main__":
    main()
