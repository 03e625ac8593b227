"""Runs the tests of weights_tools: python3 tests/weights_tools [NAME ...], in any folder.

Exits with 77, which CTest counts as skipped, where PyTorch or h5py is not installed.
"""

import importlib.util
import sys
import unittest
from pathlib import Path

SKIPPED = 77

missing = [name for name in ("torch", "h5py", "numpy") if not importlib.util.find_spec(name)]
if missing:
    print(f"skipped: needs {', '.join(f'python3-{name}' for name in missing)}")
    sys.exit(SKIPPED)

here = Path(__file__).resolve().parent
sys.path.insert(0, str(here.parent.parent))
names = sys.argv[1:] or sorted(path.stem for path in here.glob("*_test.py"))
sys.path.insert(0, str(here))
unittest.main(module=None, argv=["weights_tools", *names])
