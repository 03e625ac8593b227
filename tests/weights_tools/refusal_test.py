"""What commands of training do with input that is no good: one line, and a status that is not 0."""

import contextlib
import importlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import h5py
import torch

from tests.weights_tools import drives
from weights_tools.refusal import refusing


class RefusalTest(unittest.TestCase):
    def setUp(self) -> None:
        self.addCleanup(torch.set_num_threads, torch.get_num_threads())
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = Path(temporary.name)
        self.damaged = self.folder / "damaged"
        self.damaged.write_bytes(b"nothing of the kind")

    def refused(self, module: str, *arguments: object) -> str:
        """What the command ends with: Python prints it, and the status is 1."""
        main = importlib.import_module(f"weights_tools.{module}").main
        said = io.StringIO()
        with (
            mock.patch.object(sys, "argv", [module, *map(str, arguments)]),
            contextlib.redirect_stdout(said),
            contextlib.redirect_stderr(said),
            self.assertRaises(SystemExit) as ended,
        ):
            main()
        self.assertEqual(said.getvalue(), "")
        line = str(ended.exception.code)
        self.assertRegex(line, f"^{module.split('.')[-1]}: [^\n]+$")
        return line

    def test_damaged_files_are_named(self) -> None:
        damaged, out = self.damaged, self.folder / "out"
        log = self.folder / "stage" / "log.csv"
        log.parent.mkdir()
        log.write_text("depth\n0.1\n")
        for command in (
            ("training.train", out, "--shards", damaged),
            ("training.compare_points", damaged),
            ("training.make_dataset", out, "--seeds", 0, 0, "--circuits", "street-1.acc"),
            ("training.make_shard", damaged, out),
            ("training.plot", out, log.parent),
            ("export", out, "--checkpoint", damaged),
            ("dump_reference", "--out", out, "--networks", damaged),
        ):
            said = self.refused(*command)
            expected = log if command[0] == "training.plot" else damaged
            expected = "street-1" if "street-1.acc" in command else str(expected)
            self.assertIn(expected, said)

    def test_damaged_drives_are_named(self) -> None:
        drives.write_drive(self.folder / "drive")
        drives.write_run(self.folder / "run")
        options = (self.folder / "drive", self.folder / "out", "--run", self.folder / "run")
        with h5py.File(self.folder / "run/sparse/000002.h5", "a") as file:
            del file["confidence"]
        self.assertIn("000002.h5: is no sparse depth", self.refused("training.make_shard", *options))
        (self.folder / "run/sparse/000002.h5").write_bytes(b"none")
        self.assertIn("000002.h5: is no sparse depth", self.refused("training.make_shard", *options))
        poses = self.folder / "drive/groundtruth.txt"
        poses.write_text(poses.read_text().splitlines()[1] + "\n")
        said = self.refused("training.make_shard", *options[:2])
        self.assertIn("000002.png: groundtruth.txt has no such frame", said)
        (self.folder / "drive/sequence.yaml").write_text("fps: 10\n")
        said = self.refused("training.make_shard", *options[:2])
        self.assertIn("sequence.yaml: tells no camera_height", said)

    def test_errors_of_the_program_are_not_hidden(self) -> None:
        with self.assertRaises(KeyError), refusing("any"):
            raise KeyError("a mistake")


if __name__ == "__main__":
    unittest.main()
