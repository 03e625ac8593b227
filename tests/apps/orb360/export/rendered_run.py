"""A short drive through a rendered town and a run on it, made once for a test."""

import os
import subprocess
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[4]
BUILD = Path(os.environ.get("ORB360_BINARY_DIR", ROOT / "build"))


def run(*command: object) -> str:
    return subprocess.run([str(word) for word in command], check=True, text=True,
                          stdout=subprocess.PIPE).stdout


class RenderedRun:
    """`folder` has `town`, the input, and `run`; it vanishes with the object."""

    def __init__(self, frames: int, width: int, *more: object) -> None:
        self.temporary = tempfile.TemporaryDirectory(dir=BUILD)
        self.folder = Path(self.temporary.name)
        self.town, self.result = self.folder / "town", self.folder / "run"
        run(BUILD / "town", "render", "--town", 7, "--frames", frames, "--width", width, "--out",
            self.town)
        run(BUILD / "orb360", "run", self.town, "--mask", "none", "--quiet", "--out", self.result,
            *(more or ("--weights", "none")))

    def export(self, form: str, *more: object, name: str = "") -> Path:
        out = self.folder / (name or form)
        run(BUILD / "orb360", "export", self.result, "--to", form, "--out", out, "--quiet", *more)
        return out
