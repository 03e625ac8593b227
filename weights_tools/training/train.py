"""Trains a network on shards: python3 -m weights_tools.training.train --help

Can be stopped at any time: the same command goes on from the last checkpoint, and ends with the
weights that an uninterrupted run would have.
"""

import argparse
import csv
import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields
from pathlib import Path

import numpy as np
import torch

from weights_tools.network import Network
from weights_tools.networks import NETWORKS
from weights_tools.training.batches import Frames, collate, draw, plain
from weights_tools.training.loss import losses, pixel_weights, predicted_depth, total
from weights_tools.training.sparse_points import NoiseModel, simulate


@dataclass(frozen=True)
class Settings:
    network: str = "depth_completion"
    steps: int = 100_000
    batch: int = 4
    rate: float = 1e-3  # the highest, after the warm-up
    warm_up: int = 500  # steps
    decay: float = 1e-4  # of weights, as AdamW has it
    clip: float = 1.0  # norm of the gradient
    seed: int = 0
    checkpoint_every: int = 500  # steps


def learning_rate(settings: Settings, step: int) -> float:
    """Rises linearly, then falls to a hundredth along a cosine."""
    if step < settings.warm_up:
        return settings.rate * (step + 1) / settings.warm_up
    done = (step - settings.warm_up) / max(settings.steps - settings.warm_up, 1)
    return settings.rate * (0.01 + 0.99 * (1 + math.cos(math.pi * done)) / 2)


class Training:
    """Network, optimizer and the number of steps done, as they stand in DIR/checkpoint.pt."""

    def __init__(
        self, settings: Settings, shards: Sequence[Path], folder: Path, device: torch.device
    ) -> None:
        self.settings = settings
        self.device = device
        self.frames = Frames(shards)
        self.shards = [path.name for path in shards]
        self.step = 0
        self.network = Network(NETWORKS[settings.network](), settings.seed).to(device)
        self.optimizer = torch.optim.AdamW(
            self.network.parameters(), lr=settings.rate, weight_decay=settings.decay
        )
        self._path = folder / "checkpoint.pt"
        if self._path.exists():
            self._resume()

    def _resume(self) -> None:
        state = torch.load(self._path, map_location=self.device)
        for key, now in (("settings", asdict(self.settings)), ("shards", self.shards)):
            if state[key] != now:
                raise ValueError(
                    f"{self._path}: was made with other {key}, {state[key]}; "
                    "repeat them or choose another folder"
                )
        self.network.load_state_dict(state["network"])
        self.optimizer.load_state_dict(state["optimizer"])
        self.step = state["step"]

    def save(self) -> None:
        state = {
            "settings": asdict(self.settings),
            "shards": self.shards,
            "step": self.step,
            "network": self.network.state_dict(),
            "optimizer": self.optimizer.state_dict(),
        }
        temporary = self._path.with_name(self._path.name + ".tmp")
        torch.save(state, temporary)
        temporary.replace(self._path)

    def advance(self) -> dict[str, float]:
        """One step; gives the terms of the loss."""
        batch = draw(self.frames, self.settings.seed, self.step, self.settings.batch, NoiseModel())
        batch = batch.to(self.device)
        for group in self.optimizer.param_groups:
            group["lr"] = learning_rate(self.settings, self.step)
        self.optimizer.zero_grad()
        terms = losses(self.network, batch)
        total(terms).backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), self.settings.clip)
        self.optimizer.step()
        self.step += 1
        return {name: value.item() for name, value in terms.items()}


@torch.no_grad()
def validate(network: Network, frames: Frames, device: torch.device) -> dict[str, float]:
    """Of all frames, each with points of its own: mean relative error, and the share of the pixels
    within 1.25 of the truth. The scale of the input is taken as known."""
    sums = dict.fromkeys(("absrel", "delta1", "weight"), 0.0)
    for i in range(len(frames)):
        frame = frames[i]
        points = simulate(frame, np.random.RandomState([i, 1]))
        batch = collate([plain(frame, points)]).to(device)
        weight = pixel_weights(batch.truth)
        depth = predicted_depth(network, batch.inputs) / batch.scale
        truth = torch.where(batch.truth > 0, batch.truth, 1.0)
        sums["absrel"] += ((depth - truth).abs() / truth * weight).sum().item()
        within = torch.maximum(depth / truth, truth / depth) < 1.25
        sums["delta1"] += (within * weight).sum().item()
        sums["weight"] += weight.sum().item()
    return {name: sums[name] / max(sums["weight"], 1e-9) for name in ("absrel", "delta1")}


def train(
    settings: Settings,
    folder: Path,
    training_shards: Sequence[Path],
    validation_shards: Sequence[Path],
    device: torch.device,
    until: int | None = None,
) -> Network:
    """Trains to the end, or to step `until`. Appends a line to DIR/log.csv at each checkpoint."""
    folder.mkdir(parents=True, exist_ok=True)
    unseen = Frames(validation_shards) if validation_shards else None
    training = Training(settings, training_shards, folder, device)
    end = min(settings.steps, until or settings.steps)
    sums: dict[str, float] = {}
    since = 0
    while training.step < end:
        for name, value in training.advance().items():
            sums[name] = sums.get(name, 0.0) + value
        since += 1
        if training.step % settings.checkpoint_every == 0 or training.step == end:
            line = {name: value / since for name, value in sums.items()}
            if unseen:
                line.update(validate(training.network, unseen, device))
            training.save()
            _log(folder / "log.csv", {"step": training.step, **line})
            sums, since = {}, 0
    return training.network


def _log(path: Path, line: dict[str, float]) -> None:
    is_new = not path.exists()
    with path.open("a", newline="") as file:
        writer = csv.DictWriter(file, line)
        if is_new:
            writer.writeheader()
        writer.writerow({name: f"{value:.6g}" for name, value in line.items()})
    print(", ".join(f"{name} {value:.4g}" for name, value in line.items()), flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description="Trains a network for depth completion.")
    parser.add_argument("out", type=Path, help="folder for checkpoint.pt and log.csv")
    parser.add_argument("--shards", type=Path, nargs="+", required=True, help="to train on")
    parser.add_argument("--validation", type=Path, nargs="*", default=[], help="other shards")
    parser.add_argument("--device", default="cpu", help="as PyTorch names it (default: cpu)")
    guided = [name for name in NETWORKS if name != "unguided"]
    parser.add_argument("--network", choices=guided, default=Settings.network)
    for field in fields(Settings):
        if field.name != "network":
            option = f"--{field.name.replace('_', '-')}"
            parser.add_argument(option, type=type(field.default), default=field.default)
    arguments = vars(parser.parse_args())
    settings = Settings(**{name: arguments[name] for name in asdict(Settings())})
    train(
        settings,
        arguments["out"],
        arguments["shards"],
        arguments["validation"],
        torch.device(arguments["device"]),
    )


if __name__ == "__main__":
    main()
