"""The drives that networks are trained on: generated worlds by number, and other artists' by file.

Each drive draws light, height, tilt and speed of the camera and the effects of the sensor from its
own number or name, so the same drive is always made alike.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

LIGHTS = ("noon", "morning", "sunset", "overcast")
# Worlds that acceptance measures on: nothing is trained, tuned or measured there.
RESERVED = (
    "street-1", "aalborg", "scotland", "cocoa_temple", "lighthouse", "ravenbridge_mansion",
)  # fmt: skip
# Worlds to measure on. The first four are those of the recordings that SLAM is developed with; the
# others are of kinds that no other world for training has: caves, deserts of sand, ice, space.
HELD_OUT = (
    "ruudskogen", "mines", "candela_city", "hacienda",
    "arena_candela_city", "cave", "sandtrack", "lasdunasarena", "lasdunassoccer",
    "snowmountain", "icy_soccer_field", "stk_enterprise", "xr591",
)  # fmt: skip
_KINDS = {
    "town": "towns", "Town": "towns", "tracked": "towns", "stereo": "towns", "kart-": "karts",
    "map-": "maps", "interior": "interiors", "landscape": "landscapes", "tunnel": "tunnels",
}  # fmt: skip
# Metres that a unit of a map of Quake 3 is.
MAP_SCALE = 1 / 32


@dataclass(frozen=True)
class DriveSpec:
    """One drive."""

    name: str  # of the shard
    options: Sequence[str]  # of `town render`, without the folder
    frames: int
    is_tracked: bool = False  # by SLAM; then only frames with points of its own are kept
    has_stereo: bool = False  # ranges by stereo are among these points
    path: Sequence[str] = ()  # options of `town path`; none where the world has a path of its own


def town_spec(
    seed: int, frames: int, width: int, is_tracked: bool = False, has_stereo: bool = False
) -> DriveSpec:
    is_tracked = is_tracked or has_stereo
    random = np.random.RandomState([seed, is_tracked])
    options = ["--town", str(seed), "--light", LIGHTS[random.randint(len(LIGHTS))]]
    options += ["--traffic", f"{random.uniform():.2f}"]
    options += ["--camera-height", f"{random.uniform(0.8, 3):.3f}", *_tilt(random)]
    options += _sensor(random)
    # A frame each second when there is no tracking: some ten metres from one to the next.
    options += ["--fps", "20" if is_tracked else "1", "--width", str(width)]
    kind = "stereo" if has_stereo else "tracked" if is_tracked else "town"
    return DriveSpec(f"{kind}{seed}", options, frames, is_tracked, has_stereo)


def interior_spec(seed: int, frames: int, width: int) -> DriveSpec:
    random = np.random.RandomState([seed, 2])
    options = ["--interior", str(seed), *_tilt(random), *_sensor(random)]
    options += ["--fps", "0.5", "--width", str(width)]
    return DriveSpec(f"interior{seed}", options, frames)


def landscape_spec(seed: int, frames: int, width: int) -> DriveSpec:
    return _walk_spec("landscape", seed, frames, width)


def tunnel_spec(seed: int, frames: int, width: int) -> DriveSpec:
    return _walk_spec("tunnel", seed, frames, width)


def _walk_spec(world: str, seed: int, frames: int, width: int) -> DriveSpec:
    random = _random(world, seed)
    options = [f"--{world}", str(seed), *_tilt(random), *_sensor(random)]
    options += ["--fps", "0.5", "--width", str(width)]
    return DriveSpec(f"{world}{seed}", options, frames)


def circuit_spec(mesh: Path, frames: int, width: int) -> DriveSpec:
    """A circuit of torcs-data (.acc)."""
    random = _random(mesh.stem)
    path = ["--torcs", str(mesh), *_pace(random, (0.8, 3), (15, 30))]
    options = ["--scene", str(mesh), *_view(random, width)]
    return DriveSpec(mesh.stem, options, frames, path=path)


def kart_spec(track: Path, frames: int, width: int) -> DriveSpec:
    """A track of supertuxkart-data (its folder)."""
    random = _random(track.name)
    path = ["--kart", str(track / "scene.xml"), *_pace(random, (0.4, 3), (4, 15))]
    options = ["--scene", str(track / "scene.xml"), *_view(random, width)]
    return DriveSpec(f"kart-{track.name}", options, frames, path=path)


def map_spec(file: Path, seed: int, frames: int, width: int) -> DriveSpec:
    """A map of Quake 3 (.bsp) in its folder of the game; each seed is another walk."""
    random = _random(file.stem, seed)
    scene = ["--scene", str(file), "--scale", str(MAP_SCALE), "--up", "z"]
    # The game's own limit of steps, in which many maps are built.
    path = [*scene, "--walk", str(seed), "--length", str(6 * frames), "--step", "0.56"]
    path += _pace(random, (0.4, 2.2), (3, 3))
    return DriveSpec(
        f"map-{file.stem}-{seed}", [*scene, *_view(random, width)], frames, path=path
    )


def file_specs(
    circuits: Sequence[Path],
    karts: Sequence[Path],
    maps: Sequence[Path],
    frames: int,
    width: int,
    walks: Sequence[int] = (0,),
) -> list[DriveSpec]:
    """A drive through each world that is given by a file, and these walks through each map."""
    specs = [circuit_spec(mesh, frames, width) for mesh in circuits]
    specs += [kart_spec(track, frames, width) for track in karts]
    return specs + [map_spec(file, walk, frames, width) for file in maps for walk in walks]


def tracked(spec: DriveSpec, frames: int, speed: float) -> DriveSpec:
    """The same drive with 20 frames a second, slower, for SLAM to follow."""
    options = list(spec.options)
    options[options.index("--fps") + 1] = "20"
    path = list(spec.path)
    if path:
        path[path.index("--speed") + 1] = str(speed)
    if "--length" in path:  # a walk must be as long as the drive
        path[path.index("--length") + 1] = str(math.ceil(speed * frames / 20) + 1)
    name = f"stereo-{spec.name}"
    return replace(spec, name=name, options=options, frames=frames, path=path,
                   is_tracked=True, has_stereo=True)  # fmt: skip


def kind_of(name: str) -> str:
    """The kind of world of a drive, by the name of its shard."""
    name = name.removeprefix("stereo-")
    for prefix, kind in _KINDS.items():
        if name.startswith(prefix):
            return kind
    return "circuits"


def require_for_training(name: str) -> None:
    """Refuses worlds that are for measurements."""
    if name in (*RESERVED, *HELD_OUT):
        raise ValueError(f"{name}: is kept for measurements; leave it out")


def _random(name: str, seed: int = 0) -> np.random.RandomState:
    return np.random.RandomState([seed, *(ord(letter) for letter in name)])


def _tilt(random: np.random.RandomState) -> list[str]:
    options = ["--camera-pitch", f"{random.uniform(-5, 5):.2f}"]
    return [*options, "--camera-roll", f"{random.uniform(-5, 5):.2f}"]


def _pace(
    random: np.random.RandomState, height: tuple[float, float], speed: tuple[float, float]
) -> list[str]:
    """Metres above the ground and metres a second along a path."""
    return ["--height", f"{random.uniform(*height):.3f}", "--speed", f"{random.uniform(*speed):.1f}"]


def _view(random: np.random.RandomState, width: int) -> list[str]:
    light = LIGHTS[random.randint(len(LIGHTS))]
    return ["--light", light, *_sensor(random), "--fps", "1", "--width", str(width)]


def _sensor(random: np.random.RandomState) -> list[str]:
    options = []
    for option, probability in (("--auto-exposure", 0.5), ("--noise", 0.3), ("--dual-lens", 0.2)):
        if random.uniform() < probability:
            options.append(option)
    if random.uniform() < 0.3:
        options += ["--jpeg-quality", str(random.randint(40, 95))]
    return options
