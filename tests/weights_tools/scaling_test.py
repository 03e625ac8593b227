"""What more drives and more steps would bring."""

import contextlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import cv2
import torch

from tests.weights_tools import drives
from weights_tools.training import scaling, shards
from weights_tools.training.train import read_checkpoint


class ScalingTest(unittest.TestCase):
    def test_parts_of_the_drives_are_nested_and_each_has_a_line_and_a_curve(self) -> None:
        self.addCleanup(torch.set_num_threads, torch.get_num_threads())
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            paths = [folder / f"town{i}.npz" for i in range(9)]
            for seed, path in enumerate(paths):
                shards.write(path, shards.pack([drives.frame(seed)]))
            arguments = ["scaling", folder / "out", "--shards", *reversed(paths), "--validation", paths[0]]
            arguments += ["--steps", 2, "--every", 1, "--batch", 1, "--threads", 1]
            said = io.StringIO()
            with (
                mock.patch.object(sys, "argv", [str(each) for each in arguments]),
                contextlib.redirect_stdout(said),
            ):
                scaling.main()
            used = [
                set(read_checkpoint(folder / f"out/drives{n}/checkpoint.pt", torch.device("cpu"))["shards"])
                for n in (2, 3, 5, 9)
            ]
            for fewer, more in zip(used, used[1:]):
                self.assertLess(fewer, more)
            self.assertEqual(used[0], {"town0.npz", "town8.npz"})
            lines = said.getvalue().split("\n\n")[1].splitlines()
            self.assertEqual(lines[0], "| drives | 1 steps | 2 steps | loss in training |")
            number = r"\d+\.\d{3}"
            self.assertRegex(lines[5], rf"^\| 9 \| {number} \| {number} \| {number} \|$")
            self.assertIsNotNone(cv2.imread(str(folder / "out/scaling.png")))
            # A training that was stopped behind its line and before its checkpoint repeats the line.
            log = folder / "out/drives2/log.csv"
            log.write_text(log.read_text() + log.read_text().splitlines()[-1] + "\n")
            again = io.StringIO()
            with (
                mock.patch.object(sys, "argv", [str(each) for each in arguments]),
                contextlib.redirect_stdout(again),
            ):
                scaling.main()
            self.assertEqual(again.getvalue().split("\n\n")[-1].splitlines()[-6:], lines)


if __name__ == "__main__":
    unittest.main()
