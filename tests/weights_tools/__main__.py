"""Runs the tests of weights_tools: python3 tests/weights_tools [NAME ...], in any folder.

Exits with 77, which CTest counts as skipped, where PyTorch or another package is missing.
"""

import importlib.util
import sys
import unittest
from pathlib import Path

SKIPPED = 77

PACKAGES = {"torch": "torch", "h5py": "h5py", "numpy": "numpy", "cv2": "opencv", "yaml": "yaml"}
missing = [name for module, name in PACKAGES.items() if not importlib.util.find_spec(module)]
if missing:
    print(f"skipped: needs {', '.join(f'python3-{name}' for name in missing)}")
    sys.exit(SKIPPED)

here = Path(__file__).resolve().parent
sys.path.insert(0, str(here.parent.parent))
names = sys.argv[1:] or sorted(path.stem for path in here.glob("*_test.py"))
sys.path.insert(0, str(here))
unittest.main(module=None, argv=["weights_tools", *names])
