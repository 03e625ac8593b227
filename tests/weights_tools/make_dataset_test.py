"""Drives are drawn from their numbers, and shards that are there are not made again."""

import contextlib
import io
import stat
import sys
import tempfile
import unittest
from pathlib import Path
from unittest import mock

from tests.weights_tools import drives
from weights_tools.training import make_dataset, shards
from weights_tools.training.make_dataset import Programs, circuit_spec, town_spec

SOURCE = Path(__file__).resolve().parent.parent.parent


class MakeDatasetTest(unittest.TestCase):
    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def programs(self, town: str) -> Programs:
        for name, body in (("town", town), ("orb360", "exit 9")):
            path = self.folder / name
            path.write_text(f"#!/bin/sh\n{body}\n")
            path.chmod(path.stat().st_mode | stat.S_IXUSR)
        return Programs(self.folder / "town", self.folder / "orb360")

    def test_a_seed_always_gives_the_same_drive_and_another_another(self) -> None:
        self.assertEqual(town_spec(7, 24, 512), town_spec(7, 24, 512))
        specs = [town_spec(seed, 24, 512) for seed in range(60)]
        self.assertEqual(len({tuple(spec.options[2:]) for spec in specs}), 60)
        for name, low, high in (("camera-height", 0.8, 3), ("camera-pitch", -5, 5), ("traffic", 0, 1)):
            values = [float(s.options[s.options.index(f"--{name}") + 1]) for s in specs]
            self.assertTrue(low <= min(values) < low + 0.2 * (high - low), name)
            self.assertTrue(high - 0.2 * (high - low) < max(values) <= high, name)
        lights = {spec.options[spec.options.index("--light") + 1] for spec in specs}
        self.assertEqual(lights, set(make_dataset.LIGHTS))
        for effect in ("--noise", "--dual-lens", "--auto-exposure", "--jpeg-quality"):
            self.assertTrue(5 < sum(effect in spec.options for spec in specs) < 55, effect)

    def test_drives_with_stereo_are_tracked_with_the_network_and_others_without(self) -> None:
        for has_stereo, name in ((True, "stereo7"), (False, "tracked7")):
            spec = town_spec(7, 24, 512, is_tracked=True, has_stereo=has_stereo)
            self.assertEqual(spec.name, name)
            self.assertTrue(spec.is_tracked)
            with (
                mock.patch.object(make_dataset, "_call") as call,
                mock.patch.object(make_dataset, "read_drive", return_value=[]),
            ):
                make_dataset.render(spec, self.programs("exit 9"), self.folder)
            run = [str(part) for part in call.call_args_list[-1].args[0]]
            self.assertIn("--save-sparse", run)
            self.assertEqual("none" in run[run.index("run") + 2 : run.index("--mask")], not has_stereo)

    def test_what_is_kept_for_measurements_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, "kept for other measurements"):
            circuit_spec(Path("tracks/road/street-1/street-1.acc"), 24, 512)
        self.assertEqual(circuit_spec(Path("tracks/road/forza/forza.acc"), 24, 512).name, "forza")

    def test_drives_become_shards_of_three_sizes_once(self) -> None:
        drives.write_drive(self.folder / "made")
        # Copies a drive to where the last argument says.
        script = f'for last; do :; done; echo "$@" >> "{self.folder}/calls"; '
        script += f'cp -r "{self.folder}/made" "$last"'
        programs = self.programs(script)
        out = self.folder / "out"
        out.mkdir()
        spec = town_spec(7, 3, 128)
        for _ in range(2):
            make_dataset.make(spec, programs, out)
        calls = (self.folder / "calls").read_text().splitlines()
        self.assertEqual(len(calls), 1)
        self.assertRegex(calls[0], "^render --town 7 .*--frames 3 --masks --out ")
        full, half, quarter = (shards.read(out / s / "town7.npz") for s in make_dataset.SIZES)
        self.assertEqual((len(full), full.rgb.shape[1:3]), (2, (drives.HEIGHT, drives.WIDTH)))
        self.assertEqual(half.rgb.shape[1:3], (drives.HEIGHT // 2, drives.WIDTH // 2))
        self.assertEqual(quarter.rgb.shape[1:3], (drives.HEIGHT // 4, drives.WIDTH // 4))
        self.assertGreater(full.frame(0).ground.mean(), 0.3)
        self.assertEqual(sorted(path.name for path in out.iterdir()), sorted(make_dataset.SIZES))

    def test_a_drive_that_cannot_be_rendered_is_left_out_and_said_so(self) -> None:
        self.programs("echo broken town >&2; exit 1")
        arguments = ["make_dataset", str(self.folder / "out"), "--build", str(self.folder)]
        arguments += ["--seeds", "7", "9"]
        with mock.patch.object(sys, "argv", arguments):
            with contextlib.redirect_stdout(io.StringIO()) as printed:
                self.assertEqual(make_dataset.main(), 1)
        self.assertIn("2 of 2: town8 left out", printed.getvalue())
        self.assertIn("broken town", printed.getvalue())


if __name__ == "__main__":
    unittest.main()
