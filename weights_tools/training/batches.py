"""Training samples: a frame, sparse points simulated on it, and both changed a little.

Sample i of a seed is always the same, so that training can stop and go on.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import Tensor

from weights_tools.training import shards
from weights_tools.training.shards import Frame, Shard
from weights_tools.training.sparse_points import NoiseModel, SparsePoints, from_slam, simulate
from weights_tools.training.stereo_points import StereoNoise, simulate_stereo


@dataclass(frozen=True)
class Batch:
    """N samples; images are N x channels x H x W, the others N x 1 x 1 x 1."""

    inputs: dict[str, Tensor]  # image, depth, confidence: what networks read
    truth: Tensor  # metres; 0 where there is no surface
    ground: Tensor  # 1 in the plane of the road under the camera, else 0
    scale: Tensor  # units of the input's depth in a metre
    camera_height: Tensor  # metres

    def to(self, device: torch.device) -> "Batch":
        inputs = {name: values.to(device) for name, values in self.inputs.items()}
        rest = (self.truth, self.ground, self.scale, self.camera_height)
        return Batch(inputs, *(values.to(device) for values in rest))


class Frames:
    """All frames of some shards, of one size. A shard is read when it is first needed, and stays in memory."""

    def __init__(self, paths: Sequence[Path]) -> None:
        if not paths:
            raise ValueError("there are no shards to train on")
        self._paths = list(paths)
        self._shards: dict[int, Shard] = {}
        lengths = []
        for i, path in enumerate(self._paths):
            size, first = (self._shard(j).range.shape[1:] for j in (i, 0))
            if size != first:
                raise ValueError(
                    f"{path}: has images of {size[1]}x{size[0]}, {self._paths[0]} of "
                    f"{first[1]}x{first[0]}; take shards of one size"
                )
            lengths.append(len(self._shard(i)))
        self._first = np.cumsum([0, *lengths])

    def _shard(self, i: int) -> Shard:
        if i not in self._shards:
            self._shards[i] = shards.read(self._paths[i])
        return self._shards[i]

    def __len__(self) -> int:
        return int(self._first[-1])

    def __getitem__(self, i: int) -> Frame:
        shard = int(np.searchsorted(self._first, i, side="right")) - 1
        return self._shard(shard).frame(i - int(self._first[shard]))


def draw(frames: Frames, seed: int, step: int, size: int, model: NoiseModel) -> Batch:
    """The batch of one step of training."""
    random = np.random.RandomState([seed, step])
    samples = []
    for i in random.randint(0, len(frames), size):
        frame = frames[i]
        samples.append(augment(frame, _points(frame, random, model), random))
    return collate(samples)


def _points(frame: Frame, random: np.random.RandomState, model: NoiseModel) -> SparsePoints:
    if len(frame.points) > 0 and random.uniform() < model.from_slam:
        return from_slam(frame, random, model)
    if random.uniform() < model.from_stereo:
        return simulate_stereo(frame, random, StereoNoise(scale=model.scale))
    return simulate(frame, random, model)


@dataclass(frozen=True)
class Sample:
    image: np.ndarray  # height x width x 3, float32 in 0..1
    truth: np.ndarray
    ground: np.ndarray
    points: SparsePoints
    camera_height: float


def plain(frame: Frame, points: SparsePoints) -> Sample:
    """A sample without augmentation."""
    image = frame.rgb.astype(np.float32) / 255
    return Sample(image, frame.range, frame.ground, points, frame.camera_height)


def augment(frame: Frame, points: SparsePoints, random: np.random.RandomState) -> Sample:
    """A sample that is turned and mirrored, with other exposure, colours and noise."""
    columns = random.randint(frame.range.shape[1])
    mirror = random.randint(2) == 1

    def move(pixels: np.ndarray) -> np.ndarray:
        turned = np.roll(pixels, columns, axis=1)
        return turned[:, ::-1] if mirror else turned

    # Gains of exposure and of each colour, and a curve: what cameras of several makers do.
    gain = np.exp(random.normal(0, 0.2) + random.normal(0, 0.05, 3))
    curve = np.exp(random.normal(0, 0.15))
    levels = (np.clip(np.linspace(0, 1, 256)[:, None] * gain, 0, 1) ** curve).astype(np.float32)
    rgb = move(frame.rgb)
    image = np.stack([levels[:, i].take(rgb[..., i]) for i in range(3)], axis=-1)
    if random.uniform() < 0.2:
        image = _blur(image)
    if random.uniform() < 0.5:
        deviation = np.float32(random.uniform(0, 0.03))
        noise = np.random.Generator(np.random.PCG64(random.randint(2**31)))
        image += deviation * noise.standard_normal(image.shape, np.float32)
    moved = SparsePoints(move(points.depth), move(points.confidence), points.scale)
    image = np.clip(image, 0, 1)
    return Sample(image, move(frame.range), move(frame.ground), moved, frame.camera_height)


def _blur(image: np.ndarray) -> np.ndarray:
    """A binomial filter of three pixels that continues across the seam."""
    image = (np.roll(image, 1, axis=1) + 2 * image + np.roll(image, -1, axis=1)) / 4
    rows = np.pad(image, ((1, 1), (0, 0), (0, 0)), mode="edge")
    return (rows[:-2] + 2 * rows[1:-1] + rows[2:]) / 4


def collate(samples: Sequence[Sample]) -> Batch:
    def stacked(values: list[np.ndarray]) -> Tensor:
        return torch.from_numpy(np.stack(values).astype(np.float32))

    def numbers(values: list[float]) -> Tensor:
        return torch.tensor(values, dtype=torch.float32)[:, None, None, None]

    return Batch(
        inputs={
            "image": stacked([sample.image.transpose(2, 0, 1) for sample in samples]),
            "depth": stacked([sample.points.depth[None] for sample in samples]),
            "confidence": stacked([sample.points.confidence[None] for sample in samples]),
        },
        truth=stacked([sample.truth[None] for sample in samples]),
        ground=stacked([sample.ground[None] for sample in samples]),
        scale=numbers([sample.points.scale for sample in samples]),
        camera_height=numbers([sample.camera_height for sample in samples]),
    )
