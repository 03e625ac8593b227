"""Equirectangular images: bearings of pixels, and resampling. For the scripts beside it."""

import cv2
import numpy as np


def bearings(height: int, width: int) -> np.ndarray:
    """Unit bearings of all pixels, camera frame: x right, y down, z forward. (height, width, 3)."""
    longitude = ((np.arange(width) + 0.5) / width - 0.5) * 2 * np.pi
    latitude = (0.5 - (np.arange(height) + 0.5) / height) * np.pi
    longitude, latitude = np.meshgrid(longitude, latitude)
    return np.stack([np.cos(latitude) * np.sin(longitude), -np.sin(latitude),
                     np.cos(latitude) * np.cos(longitude)], axis=-1)


def sample(image: np.ndarray, rays: np.ndarray, interpolation: int) -> np.ndarray:
    """The image's values in the directions `rays`, unit, camera frame. (height, width, 3)."""
    height, width = image.shape[:2]
    border = 8  # columns, for the interpolation across the seam
    u = (np.arctan2(rays[..., 0], rays[..., 2]) / (2 * np.pi) + 0.5) * width - 0.5
    v = (0.5 + np.arcsin(np.clip(rays[..., 1], -1, 1)) / np.pi) * height - 0.5
    wide = cv2.copyMakeBorder(image, 0, 0, border, border, cv2.BORDER_WRAP)
    return cv2.remap(wide, (u + border).astype(np.float32), v.astype(np.float32), interpolation,
                     borderMode=cv2.BORDER_REPLICATE)
