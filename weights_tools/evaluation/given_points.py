"""The points that networks are measured with."""

import numpy as np

from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import NoiseModel, SparsePoints, from_slam, simulate
from weights_tools.training.stereo_points import StereoNoise, simulate_stereo

SLAM = "slam"
MAX_LANDMARKS = 3000


def points_of(frame: Frame, kind: str, seed: int) -> SparsePoints | None:
    """Points in metres. `kind` is a number of points, of simulated landmarks up to MAX_LANDMARKS and of
    simulated stereo beyond; with SLAM they are those that SLAM itself gave, or None where the frame
    has none. The number is that in an image of 1024 x 512 pixels."""
    if kind == SLAM:
        model = NoiseModel(scale=(1, 1), thinned=0)
        random = np.random.RandomState([seed, 0])
        return from_slam(frame, random, model) if len(frame.points) > 0 else None
    count = int(kind)
    random = np.random.RandomState([seed, count])
    if count <= MAX_LANDMARKS:
        return simulate(frame, random, NoiseModel(points=(count, count), scale=(1, 1)))
    return simulate_stereo(frame, random, StereoNoise(points=(count, count), scale=(1, 1)))
