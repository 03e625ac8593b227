"""Draws learning curves: python3 -m weights_tools.training.plot OUT.png DIR ..."""

import argparse
import csv
from pathlib import Path

import numpy as np

from weights_tools.evaluation.pictures import write_chart

COLUMNS = ("depth", "unseen_absrel", "unseen_scale_error")


def main() -> None:
    parser = argparse.ArgumentParser(description="Draws learning curves.")
    parser.add_argument("out", type=Path, help="picture to write (.png)")
    parser.add_argument("folders", type=Path, nargs="+", help="of weights_tools.training.train")
    arguments = parser.parse_args()
    curves = {}
    for folder in arguments.folders:
        with (folder / "log.csv").open() as file:
            lines = list(csv.DictReader(file))
        steps = np.array([int(line["step"]) for line in lines])
        for name in COLUMNS:
            if lines and name in lines[0]:
                values = np.array([float(line[name]) for line in lines])
                curves[f"{folder.name}: {name}"] = (steps, values)
    write_chart(arguments.out, "step", "error", curves)


if __name__ == "__main__":
    main()
