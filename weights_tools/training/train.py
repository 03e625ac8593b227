"""Trains a network on shards: python3 -m weights_tools.training.train --help

Can be stopped at any time: the same command goes on from the last checkpoint, and ends with the
weights that an uninterrupted run would have.
"""

import argparse
import copy
import csv
import hashlib
import math
import os
import pickle
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any

import torch

from weights_tools.ablation import without
from weights_tools.builder import Description
from weights_tools.network import Network
from weights_tools.networks import NETWORKS
from weights_tools.refusal import refusing
from weights_tools.training.batches import Batch, Frames, draw
from weights_tools.training.loss import losses, total
from weights_tools.training.optimizers import make_optimizers
from weights_tools.training.sparse_points import NoiseModel
from weights_tools.training.validate import validate


@dataclass(frozen=True)
class Settings:
    network: str = "depth_completion"
    steps: int = 100_000
    batch: int = 4
    rate: float = 1e-3  # the highest, after the warm-up
    warm_up: int = 500  # steps
    decay: float = 1e-4  # of weights, per step and unit of the rate
    clip: float = 1.0  # norm of the gradient
    seed: int = 0
    average: float = 0.999  # fraction that a step keeps of the weights' mean, which is exported
    bfloat16: bool = False  # convolutions in that type, for processors that are faster at it
    fixed_propagation: bool = False  # normalized convolutions of the first estimate stay as they start
    only: str = ""  # layers whose names begin so are trained, the others stay as they start
    batch_normalization: bool = False  # while it is trained; it ends up in the weights
    normals: float = 0.0  # weight of the error of surface normals, a second task
    zeroed: str = ""  # tensors that count nothing, for ablations; their names with spaces between
    checkpoint_every: int = 500  # steps


def describe(network: str, zeroed: str) -> Description:
    return without(NETWORKS[network](), zeroed.split())


def learning_rate(settings: Settings, step: int) -> float:
    """Rises linearly, then falls to a hundredth along a cosine."""
    if step < settings.warm_up:
        return settings.rate * (step + 1) / settings.warm_up
    done = (step - settings.warm_up) / max(settings.steps - settings.warm_up, 1)
    return settings.rate * (0.01 + 0.99 * (1 + math.cos(math.pi * done)) / 2)


class Training:
    """Network, optimizers and number of steps done, saved in DIR/checkpoint.pt."""

    def __init__(
        self,
        settings: Settings,
        shards: Sequence[Path],
        folder: Path,
        device: torch.device,
        starts: Sequence[Path] = (),
    ) -> None:
        self.settings = settings
        self.device = device
        self.frames = Frames(shards)
        self.shards = [path.name for path in shards]
        self.step = 0
        self.stages: list[dict[str, Any]] = []  # of training, before this one
        description = describe(settings.network, settings.zeroed)
        normalizes = settings.batch_normalization
        self.network = Network(description, settings.seed, normalizes, settings.only).to(device)
        self._model = NoiseModel()
        if not self.network.knows_any_unit:
            self._model = replace(self._model, scale=(1.0, 1.0))
        self._path = folder / "checkpoint.pt"
        if not self._path.exists():
            for path in starts:
                self._start_from(path)
        self.mean = copy.deepcopy(self.network).requires_grad_(False).eval()
        if settings.fixed_propagation:
            self.network.fix_propagation()
        self.network.fix_others(settings.only)
        self.optimizers = make_optimizers(
            self.network, settings.rate, settings.decay, settings.bfloat16
        )
        if self._path.exists():
            self._resume()

    def _start_from(self, path: Path) -> None:
        """Loads the layers that this network shares with a checkpoint or a network file."""
        if path.suffix == ".h5":
            weights, stages = _read_network_file(path)
        else:
            state = read_checkpoint(path, self.device)
            other = checkpoint_network(state)
            digest = hashlib.sha256(path.read_bytes()).hexdigest()
            stages = [*state["stages"], {**stage(state), "checkpoint": digest}]
            normalizes = state["settings"]["batch_normalization"], self.settings.batch_normalization
            only = state["settings"].get("only", "") or self.settings.only
            if all(normalizes) and not only:
                self._load_state(other)
                self.stages += stages
                return
            weights = other.weights()
        self.stages += stages
        own = self.network.weights()
        common = {n: _widened(values, own[n]) for n, values in weights.items() if n in own}
        self.network.load({name: values.detach() for name, values in {**own, **common}.items()})
        self.network.to(self.device)
        known = [name for name in self.network.normalizations if f"{name}.weight" in common]
        if known:
            # The step after the last, which training itself never draws.
            seed, step, size = self.settings.seed, self.settings.steps, self.settings.batch
            batch = draw(self.frames, seed, step, size, self._model)
            inputs = batch.to(self.device).inputs
            self.network.calibrate(inputs, known, self.settings.bfloat16)

    def _load_state(self, other: Network) -> None:
        """Loads another network's layers and their normalization; all of its own layers are new
        where the other has none."""
        state = other.state_dict()
        new, _ = self.network.load_state_dict(state, strict=False)
        known = {layer.name for layer in other.description.layers}
        missing = [name for name in new if name.split(".")[1] in known]
        if missing:
            raise ValueError(f"the start lacks {missing[0]}")

    def _resume(self) -> None:
        state = read_checkpoint(self._path, self.device)
        for key, now in (("settings", asdict(self.settings)), ("shards", self.shards)):
            if state[key] != now:
                raise ValueError(
                    f"{self._path}: was made with other {key}, {state[key]}; "
                    "repeat them or choose another folder"
                )
        if "optimizers" not in state:
            raise ValueError(
                f"{self._path}: comes from an older version, whose steps were others; "
                "give it to another folder's training by --start"
            )
        self.network.load_state_dict(state["network"])
        self.mean.load_state_dict(state["mean"])
        for optimizer, kept in zip(self.optimizers, state["optimizers"], strict=True):
            optimizer.load_state_dict(kept)
        self.step, self.stages = state["step"], state["stages"]

    def save(self) -> None:
        state = {
            "settings": asdict(self.settings),
            "shards": self.shards,
            "width": self.frames[0].rgb.shape[1],
            "step": self.step,
            "stages": self.stages,
            "network": self.network.state_dict(),
            "mean": self.mean.state_dict(),
            "optimizers": [optimizer.state_dict() for optimizer in self.optimizers],
        }
        temporary = self._path.with_name(self._path.name + ".tmp")
        torch.save(state, temporary)
        temporary.replace(self._path)

    def batches(self, end: int) -> Iterator[Batch]:
        """The batches of the steps up to `end`; the next one is prepared while one is used."""

        def make(step: int) -> Batch:
            return draw(self.frames, self.settings.seed, step, self.settings.batch, self._model)

        with ThreadPoolExecutor(1) as maker:
            coming = maker.submit(make, self.step)
            for step in range(self.step, end):
                batch = coming.result()
                if step + 1 < end:
                    coming = maker.submit(make, step + 1)
                yield batch.to(self.device)

    def advance(self, batch: Batch) -> dict[str, float]:
        """One step; gives the terms of the loss."""
        for optimizer in self.optimizers:
            for group in optimizer.param_groups:
                group["lr"] = learning_rate(self.settings, self.step)
            optimizer.zero_grad()
        normals = self.settings.normals
        terms = losses(self.network, batch, self.settings.bfloat16, normals > 0)
        total(terms, normals).backward()
        torch.nn.utils.clip_grad_norm_(self.network.parameters(), self.settings.clip)
        for optimizer in self.optimizers:
            optimizer.step()
        self.step += 1
        # The mean of few steps keeps less, so that it forgets the first weights sooner.
        keep = min(self.settings.average, self.step / (self.step + 10))
        with torch.no_grad():
            now = self.network.state_dict()
            for name, mean in self.mean.state_dict().items():
                if mean.is_floating_point():
                    mean.lerp_(now[name], 1 - keep)
        return {name: value.item() for name, value in terms.items()}


def _widened(values: torch.Tensor, like: torch.Tensor) -> torch.Tensor:
    """Weights of a layer that had fewer inputs, with zeros for the new inputs, which come last."""
    more = like.shape[1] - values.shape[1] if values.dim() > 1 else 0
    if more <= 0:
        return values
    return torch.cat([values, values.new_zeros(len(values), more, *values.shape[2:])], dim=1)


def _read_network_file(path: Path) -> tuple[dict[str, torch.Tensor], list[dict[str, Any]]]:
    """Weights and the stages of their training."""
    from weights_tools import network_file  # needs h5py, which training does without otherwise

    graph, weights = network_file.read(path)
    last = dict(graph.provenance)
    stages = [*last.pop("earlier", []), last]
    return {name: torch.from_numpy(values).float() for name, values in weights.items()}, stages


def read_checkpoint(path: Path, device: torch.device) -> dict[str, Any]:
    try:
        state = torch.load(path, map_location=device)
    except (RuntimeError, EOFError, KeyError, pickle.UnpicklingError) as error:
        raise ValueError(f"{path}: is no checkpoint, or a damaged one") from error
    if not isinstance(state, dict) or not {"settings", "step", "mean"} <= state.keys():
        raise ValueError(f"{path}: is no checkpoint of a training")
    return state


def checkpoint_network(state: dict[str, Any]) -> Network:
    """The mean network that a checkpoint holds."""
    settings = state["settings"]
    normalizes = settings["batch_normalization"]
    only = settings.get("only", "")
    description = describe(settings["network"], settings.get("zeroed", ""))
    network = Network(description, normalizes=normalizes, only=only)
    network.load_state_dict(state["mean"])
    return network.eval()


def stage(state: dict[str, Any]) -> dict[str, Any]:
    """The entry of a network's provenance that describes the training of a checkpoint."""
    return {"steps_done": state["step"], **state["settings"], "shards": state["shards"]}


def train(
    settings: Settings,
    folder: Path,
    training_shards: Sequence[Path],
    validation_shards: Sequence[Path],
    device: torch.device,
    starts: Sequence[Path] = (),
    until: int | None = None,
) -> Network:
    """Trains to the end, or to step `until`; gives the mean of the weights. Appends a line to
    DIR/log.csv at each checkpoint."""
    folder.mkdir(parents=True, exist_ok=True)
    unseen = Frames(validation_shards) if validation_shards else None
    training = Training(settings, training_shards, folder, device, starts)
    end = min(settings.steps, until or settings.steps)
    sums: dict[str, float] = {}
    since = 0
    for batch in training.batches(end):
        for name, value in training.advance(batch).items():
            sums[name] = sums.get(name, 0.0) + value
        since += 1
        if training.step % settings.checkpoint_every == 0 or training.step == end:
            line = {name: value / since for name, value in sums.items()}
            if unseen:
                measured = validate(training.mean, unseen, device, settings.bfloat16)
                line.update({f"unseen_{name}": value for name, value in measured.items()})
            # Before the checkpoint: a stop between both repeats a line and leaves none out.
            _log(folder / "log.csv", {"step": training.step, **line})
            training.save()
            sums, since = {}, 0
    return training.mean


def _log(path: Path, line: dict[str, float]) -> None:
    is_new = not path.exists()
    with path.open("a", newline="") as file:
        writer = csv.DictWriter(file, line)
        if is_new:
            writer.writeheader()
        writer.writerow({name: f"{value:.6g}" for name, value in line.items()})
    print(", ".join(f"{name} {value:.4g}" for name, value in line.items()), flush=True)


@refusing("train")
def main() -> None:
    parser = argparse.ArgumentParser(description="Trains a network for depth completion.")
    parser.add_argument("out", type=Path, help="folder for checkpoint.pt and log.csv")
    parser.add_argument("--shards", type=Path, nargs="+", required=True, help="to train on")
    parser.add_argument("--validation", type=Path, nargs="*", default=[], help="other shards")
    parser.add_argument("--device", default="cpu", help="as PyTorch names it (default: cpu)")
    parser.add_argument("--threads", type=int, default=os.cpu_count(),
                        help="of the CPU (default: as many as it has)")  # fmt: skip
    parser.add_argument("--start", type=Path, nargs="*", default=[],
                        help="checkpoints or network files to take layers from, in this order")  # fmt: skip
    parser.add_argument("--network", choices=list(NETWORKS), default=Settings.network)
    for field in fields(Settings):
        option = f"--{field.name.replace('_', '-')}"
        if field.type is bool:
            parser.add_argument(option, action="store_true")
        elif field.name != "network":
            parser.add_argument(option, type=type(field.default), default=field.default)
    arguments = vars(parser.parse_args())
    torch.set_num_threads(arguments["threads"])
    settings = Settings(**{name: arguments[name] for name in asdict(Settings())})
    train(
        settings,
        arguments["out"],
        arguments["shards"],
        arguments["validation"],
        torch.device(arguments["device"]),
        arguments["start"],
    )


if __name__ == "__main__":
    main()
