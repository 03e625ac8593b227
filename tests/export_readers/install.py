"""Installs the readers of this folder, at the versions of package-lock.json, below the build folder.
Ends with 77 (skipped) where there is no npm, or no way to what it installs from."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
UNREACHABLE = ("ENOTFOUND", "EAI_AGAIN", "ECONNREFUSED", "ENETUNREACH", "ETIMEDOUT")


def main() -> int:
    if shutil.which("npm") is None:
        print("skipped: there is no npm; install Debian's packages nodejs and npm")
        return 77
    folder = Path(os.environ["ORB360_BINARY_DIR"]) / "export_readers"
    folder.mkdir(exist_ok=True)
    lock = HERE / "package-lock.json"
    done = folder / "installed"  # the lock file of what was installed
    is_done = done.exists() and done.read_bytes() == lock.read_bytes()
    for path in HERE.iterdir():
        if path.suffix in (".json", ".mjs"):
            shutil.copy(path, folder)
    if is_done:
        return 0
    npm = subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"], cwd=folder,
                         check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(npm.stdout)
    if npm.returncode != 0:
        return 77 if any(word in npm.stdout for word in UNREACHABLE) else 1
    shutil.copy(lock, done)
    return 0


if __name__ == "__main__":
    sys.exit(main())
