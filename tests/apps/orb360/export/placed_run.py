"""A place on Earth for a run, and coordinates there by PROJ's own program."""

import json
import subprocess
from pathlib import Path

import numpy as np

ORIGIN = (47.3769, 8.5417, 408.0)  # degrees, metres over the ellipsoid
SCALE = 1.5  # metres in a unit of the run's world
TRANSLATION = np.array([12.0, -7.0, 1.5])
HEADING = np.radians(35)  # of the world's x axis, from east to north
LOCAL_FROM_WORLD = np.array([[np.cos(HEADING), -np.sin(HEADING), 0],
                             [np.sin(HEADING), np.cos(HEADING), 0], [0, 0, 1]])
UTC_AT_ZERO = 1741935600.25  # 2025-03-14T07:00:00.250Z
AXIS, FLATTENING = 6378137.0, 1 / 298.257223563  # of WGS 84


def write_georeference(path: Path, reference: str = "WGS 84 ellipsoid") -> None:
    """As docs/formats/georeference.md has it."""
    half = HEADING / 2
    path.write_text(json.dumps({
        "version": 1,
        "origin": dict(zip(("latitude", "longitude", "altitude"), ORIGIN)),
        "altitude_reference": reference, "utm_epsg": 32632,
        "local_from_world": {"scale": SCALE, "rotation": [0, 0, np.sin(half), np.cos(half)],
                             "translation": list(TRANSLATION)},
        "sigma": {"scale": 0.01, "heading_deg": 0.5, "tilt_deg": 0.2, "horizontal": 1.2,
                  "vertical": 2.5},
        "center": [0, 0, 0], "clock_offset": {"value": 0, "sigma": 0},
        "utc_at_zero": "2025-03-14T07:00:00.250Z",
        "fixes": {"source": "a test", "used": 30, "sigma": 3, "correlated_fraction": 0.5,
                  "correlation_time": 60, "median_distance": 2}}))


def to_local(world: np.ndarray) -> np.ndarray:
    """Metres to the east, north and up of points (n x 3) of the run's world."""
    return SCALE * world @ LOCAL_FROM_WORLD.T + TRANSLATION


def to_earth(world: np.ndarray, target: str) -> np.ndarray:
    """The same points in a coordinate system of cs2cs, by way of the centre of the Earth."""
    phi, lam = np.radians(ORIGIN[:2])
    squared = FLATTENING * (2 - FLATTENING)
    normal = AXIS / np.sqrt(1 - squared * np.sin(phi) ** 2)
    up = np.array([np.cos(phi) * np.cos(lam), np.cos(phi) * np.sin(lam), np.sin(phi)])
    east = np.array([-np.sin(lam), np.cos(lam), 0])
    origin = ORIGIN[2] * up + normal * up * [1, 1, 1 - squared]
    points = origin + to_local(world) @ np.stack([east, np.cross(up, east), up])
    text = "\n".join(" ".join(f"{x:.6f}" for x in point) for point in points)
    done = subprocess.run(["cs2cs", "-f", "%.9f", *"+proj=geocent +datum=WGS84 +to".split(),
                           *target.split()], input=text, check=True, text=True,
                          stdout=subprocess.PIPE)
    return np.array([[float(word) for word in line.split()] for line in done.stdout.splitlines()])
