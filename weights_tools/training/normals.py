"""Surface normals of range images."""

import numpy as np
import torch
import torch.nn.functional as F
from torch import Tensor

from weights_tools.training.sphere import bearings


def surface_normals(depth: Tensor) -> Tensor:
    """Unit normals of the surface that a range image shows, in the camera's frame: B x 1 x H x W ->
    B x 3 x (H - 2) x W, without the first and the last row. They come from the two neighbours in
    each direction; left and right edge are neighbours."""
    height, width = depth.shape[-2:]
    v, u = np.mgrid[0:height, 0:width] + 0.5
    points = depth * torch.from_numpy(bearings(u, v, height, width)).to(depth).permute(2, 0, 1)
    across = (points.roll(-1, -1) - points.roll(1, -1))[..., 1:-1, :]
    down = points[..., 2:, :] - points[..., :-2, :]
    return F.normalize(torch.linalg.cross(across, down, dim=1), dim=1, eps=1e-12)
