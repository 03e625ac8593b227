"""What commands of training do with input that is no good: one line, and a status that is not 0."""

import contextlib
import importlib
import io
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

import cv2
import h5py
import torch

from tests.weights_tools import drives
from weights_tools.refusal import refusing
from weights_tools.training import make_shard, shards

WEIGHTS = Path(__file__).resolve().parent.parent.parent / "weights/encoder_decoder.h5"


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
            ("training.ablate", out, "--shards", damaged, "--validation", damaged),
            ("training.scaling", out, "--shards", *[damaged] * 8, "--validation", damaged),
            ("training.compare_points", damaged),
            ("evaluation.error_parts", WEIGHTS, damaged),
            ("training.make_dataset", out, "--seeds", 0, 0, "--circuits", "street-1.acc"),
            ("training.retrain", out, "--circuits", "street-1.acc"),
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
        known_poses = poses.read_text()
        first = known_poses.splitlines()[1]
        for text, message in (
            (first, "000002.png: groundtruth.txt has no such frame"),
            ("", "groundtruth.txt: has no poses"),
            (f"{first}\n1 2 3", "groundtruth.txt: has no poses"),
            ("a b c d e f g h", "groundtruth.txt: has no poses"),
        ):
            poses.write_text(f"# a comment\n{text}\n")
            self.assertIn(message, self.refused("training.make_shard", *options[:2]))
        poses.write_text(known_poses)
        (self.folder / "drive/sequence.yaml").write_text("- fps\n")
        said = self.refused("training.make_shard", *options[:2])
        self.assertIn("sequence.yaml: is no description of a drive", said)

    def test_images_of_another_size_are_named(self) -> None:
        drive, out = self.folder / "drive", self.folder / "out"
        drives.write_drive(drive)
        for name in ("rgb/000000.jpg", "moving/000000.png", "depth/000002.png"):
            path = drive / name
            kept = path.read_bytes()
            cv2.imwrite(str(path), cv2.imread(str(path), cv2.IMREAD_UNCHANGED)[::2, ::2])
            said = self.refused("training.make_shard", drive, out)
            self.assertIn(f"{name}: has another size", said)
            path.write_bytes(kept)

    def test_shards_of_two_sizes_are_named(self) -> None:
        paths = [self.folder / "half.npz", self.folder / "quarter.npz"]
        for path, frame in zip(paths, (drives.frame(), make_shard.halved(drives.frame()))):
            shards.write(path, shards.pack([frame]))
        said = self.refused("training.train", self.folder / "out", "--shards", *paths)
        self.assertIn(f"{paths[1]}: has images of 64x32, {paths[0]} of 128x64", said)

    def test_errors_of_the_program_are_not_hidden(self) -> None:
        with self.assertRaises(KeyError), refusing("any"):
            raise KeyError("a mistake")


if __name__ == "__main__":
    unittest.main()
