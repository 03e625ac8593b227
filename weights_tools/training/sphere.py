"""Equirectangular images (docs/concepts/camera_model.md): camera -X forward, +Y right, +Z up."""

import numpy as np


def bearings(u: np.ndarray, v: np.ndarray, height: int, width: int) -> np.ndarray:
    """Unit vectors of pixel coordinates (the first pixel's centre is at 0.5), ... x 3."""
    longitude = (u / width - 0.5) * 2 * np.pi
    latitude = (0.5 - v / height) * np.pi
    cosine = np.cos(latitude)
    return np.stack(
        [-cosine * np.cos(longitude), cosine * np.sin(longitude), np.sin(latitude)], axis=-1
    )


def row_weights(height: int) -> np.ndarray:
    """Solid angle of a pixel of each row as a fraction of the mean pixel's."""
    cosine = np.cos((0.5 - (np.arange(height) + 0.5) / height) * np.pi)
    return cosine / cosine.mean()
