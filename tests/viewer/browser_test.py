"""Renders a drive, runs on it, and looks at it in a browser (browser_*test.mjs). Ends with 77 (skipped) where there is none."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

BUILD = Path(os.environ["ORB360_BINARY_DIR"])


def main() -> int:
    chromium = shutil.which("chromium")
    if chromium is None:
        print("skipped: there is no chromium; scripts/install_packages --checks installs it")
        return 77
    out = BUILD / "viewer_tests" / "data"
    shutil.rmtree(out, ignore_errors=True)
    quiet = {"check": True, "stdout": subprocess.DEVNULL}
    subprocess.run([BUILD / "town", "render", "--town", "7", "--frames", "60", "--width", "768",
                    "--out", out / "town"], **quiet)
    subprocess.run([BUILD / "orb360", "run", out / "town", "--out", out / "run", "--mask", "none",
                    "--save-views"], **quiet)
    report = out / "report.html"
    subprocess.run([BUILD / "orb360", "report", out / "run", "--out", report, "--max-size", "12"],
                   **quiet)
    compared = out / "compared.html"
    subprocess.run([BUILD / "orb360", "report", out / "run", "--out", compared, "--max-size", "4",
                    "--views", "0", "--compare", out / "town"], **quiet)
    environment = {**os.environ, "ORB360_RUN": str(out / "run"), "ORB360_TOWN": str(out / "town"),
                   "ORB360_REPORT": str(report), "ORB360_COMPARED": str(compared),
                   "ORB360_CHROMIUM": chromium}
    tests = subprocess.run(["node", "--test", "--test-concurrency=1", "browser_test.mjs",
                            "browser_states_test.mjs", "browser_live_test.mjs",
                            "browser_compare_test.mjs"],
                           cwd=BUILD / "viewer_tests", env=environment, check=False)
    return 1 if tests.returncode != 0 else 0


if __name__ == "__main__":
    sys.exit(main())
