"""Readers of other people, which tests/export_readers installs."""

import json
import shutil
import subprocess
from pathlib import Path
from typing import Any

from rendered_run import BUILD

FOLDER = BUILD / "export_readers"


def why_missing() -> str | None:
    """Why there are no such readers; None where there are."""
    if shutil.which("node") is None:
        return "there is no node; install Debian's packages nodejs and npm"
    if not (FOLDER / "installed").exists():
        return "they are not installed; ctest -R export_readers installs them with npm"
    return None


def read(script: str, path: Path) -> Any:
    done = subprocess.run(["node", FOLDER / script, path], check=False, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    if done.returncode != 0:
        raise AssertionError(f"{script}: {done.stderr.strip()[-2000:]}")
    return json.loads(done.stdout)
