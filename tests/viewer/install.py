"""Installs what the tests of the viewer's page use from npm below the build folder, at the versions of
their package-lock.json: esbuild, TypeScript and three.js with a copy of the page's sources, and the
driver of the browser. Ends with 77 (skipped) where there is no npm, or no way to what it installs
from."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
WEB = HERE.parent.parent / "slam" / "viewer" / "web"
UNREACHABLE = ("ENOTFOUND", "EAI_AGAIN", "ECONNREFUSED", "ENETUNREACH", "ETIMEDOUT")


def install(source: Path, names: list[str], folder: Path) -> int:
    folder.mkdir(exist_ok=True)
    for name in names:
        if (source / name).is_dir():
            shutil.rmtree(folder / name, ignore_errors=True)
            shutil.copytree(source / name, folder / name)
        else:
            shutil.copy(source / name, folder)
    lock = source / "package-lock.json"
    done = folder / "installed"  # the lock file of what was installed
    if done.exists() and done.read_bytes() == lock.read_bytes():
        return 0
    npm = subprocess.run(["npm", "ci", "--ignore-scripts", "--no-audit", "--no-fund"], cwd=folder,
                         check=False, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    print(npm.stdout)
    if npm.returncode != 0:
        return 77 if any(word in npm.stdout for word in UNREACHABLE) else 1
    shutil.copy(lock, done)
    return 0


def main() -> int:
    if shutil.which("npm") is None:
        print("skipped: there is no npm; install Debian's packages nodejs and npm")
        return 77
    build = Path(os.environ["ORB360_BINARY_DIR"])
    packages = ["package.json", "package-lock.json"]
    return (install(WEB, [*packages, "tsconfig.json", "build.mjs", "src"], build / "viewer_web")
            or install(HERE, [*packages, *(path.name for path in HERE.glob("*.mjs"))],
                       build / "viewer_tests"))


if __name__ == "__main__":
    sys.exit(main())
