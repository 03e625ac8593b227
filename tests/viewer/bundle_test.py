"""The page that is compiled into the programs is what its sources make, and these are typed."""

import os
import subprocess
import tempfile
import unittest
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
WEB = Path(os.environ["ORB360_BINARY_DIR"]) / "viewer_web"
SHIPPED = ROOT / "slam" / "viewer" / "web" / "dist"


class Bundle(unittest.TestCase):
    def test_has_the_types_that_it_states(self) -> None:
        check = subprocess.run(["node", "node_modules/typescript/bin/tsc", "--noEmit", "-p", "."],
                               cwd=WEB, check=False, text=True, stdout=subprocess.PIPE)
        self.assertEqual(check.stdout, "")
        self.assertEqual(check.returncode, 0)

    def test_is_what_the_sources_make(self) -> None:
        with tempfile.TemporaryDirectory() as folder:
            subprocess.run(["node", "build.mjs", folder], cwd=WEB, check=True)
            made = {path.name: path.read_bytes() for path in Path(folder).iterdir()}
        shipped = {path.name: path.read_bytes() for path in SHIPPED.iterdir()}
        self.assertEqual(set(made), set(shipped))
        for name, content in made.items():
            with self.subTest(name):
                self.assertTrue(content == shipped[name],
                                "differs; run `npm ci && npm run build` in slam/viewer/web")

    def test_is_small(self) -> None:
        self.assertLess(sum(path.stat().st_size for path in SHIPPED.iterdir()), 1_500_000)


if __name__ == "__main__":
    unittest.main()
