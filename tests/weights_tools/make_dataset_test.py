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
from weights_tools.training import make_dataset, shards, worlds
from weights_tools.training.make_dataset import Programs
from weights_tools.training.worlds import DriveSpec, town_spec

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
        self.assertEqual(lights, set(worlds.LIGHTS))
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
                contextlib.suppress(make_dataset.DriveError),
            ):
                make_dataset.render(spec, self.programs("exit 9"), self.folder)
            run = [str(part) for part in call.call_args_list[-1].args[0]]
            self.assertIn("--save-sparse", run)
            self.assertEqual("none" in run[run.index("run") + 2 : run.index("--mask")], not has_stereo)

    def run_main(self, *arguments: str) -> str:
        """What make_dataset prints, with programs that are in the folder."""
        words = ["make_dataset", str(self.folder / "out"), "--build", str(self.folder), *arguments]
        with (
            mock.patch.object(sys, "argv", words),
            contextlib.redirect_stdout(io.StringIO()) as printed,
        ):
            try:
                make_dataset.main()
            except SystemExit as refusal:
                return str(refusal)
        return printed.getvalue()

    def test_what_is_kept_for_measurements_is_refused(self) -> None:
        self.programs("exit 1")
        for option, path in (
            ("--circuits", "tracks/road/street-1/street-1.acc"),
            ("--karts", "tracks/scotland"),
            ("--karts", "tracks/mines"),
        ):
            self.assertIn("kept for measurements", self.run_main("--seeds", "0", "0", option, path))
        printed = self.run_main("--seeds", "0", "0", "--held-out", "--karts", "tracks/mines")
        self.assertIn("1 of 1: kart-mines left out", printed)

    def test_a_drive_without_depth_or_points_is_left_out(self) -> None:
        spec = worlds.town_spec(7, 3, 128, has_stereo=True)
        for read, message in (
            ({"side_effect": ValueError("has no depth")}, "has no depth"),
            ({"return_value": [drives.frame()]}, "SLAM found no points"),
        ):
            with (
                mock.patch.object(make_dataset, "_call"),
                mock.patch.object(make_dataset, "read_drive", **read),
                self.assertRaisesRegex(make_dataset.DriveError, message),
            ):
                make_dataset.render(spec, self.programs("exit 9"), self.folder)

    def test_each_world_has_its_own_path_and_options(self) -> None:
        specs = {
            spec.name: spec
            for spec in (
                worlds.circuit_spec(Path("road/forza/forza.acc"), 24, 512),
                worlds.kart_spec(Path("tracks/zengarden"), 24, 512),
                worlds.map_spec(Path("maps/hall.bsp"), 3, 24, 512),
                worlds.interior_spec(9, 24, 512),
                worlds.landscape_spec(9, 24, 512),
                worlds.tunnel_spec(10, 24, 512),
            )
        }
        names = ["forza", "kart-zengarden", "map-hall-3", "interior9", "landscape9", "tunnel10"]
        self.assertEqual(list(specs), names)
        kinds = ["circuits", "karts", "maps", "interiors", "landscapes", "tunnels"]
        self.assertEqual([worlds.kind_of(f"stereo-{name}") for name in names], kinds)
        self.assertEqual(specs["tunnel10"].options[:2], ["--tunnel", "10"])
        self.assertEqual(list(specs["forza"].path[:2]), ["--torcs", "road/forza/forza.acc"])
        self.assertEqual(list(specs["kart-zengarden"].options[:2]), ["--scene", "tracks/zengarden/scene.xml"])
        self.assertEqual(specs["map-hall-3"].options[:6], specs["map-hall-3"].path[:6])
        self.assertFalse(specs["interior9"].path or specs["landscape9"].path)
        for spec in specs.values():
            followed = worlds.tracked(spec, 200, 4.5)
            if "--length" in followed.path:
                self.assertEqual(followed.path[followed.path.index("--length") + 1], "46")
            self.assertTrue(followed.is_tracked and followed.has_stereo)
            self.assertEqual((followed.name, followed.frames), (f"stereo-{spec.name}", 200))
            self.assertEqual(followed.options[followed.options.index("--fps") + 1], "20")
            if spec.path:
                self.assertEqual(followed.path[followed.path.index("--speed") + 1], "4.5")

    def test_a_path_is_found_before_the_drive_is_rendered(self) -> None:
        spec = DriveSpec("x", ["--scene", "x.obj"], 5, path=["--kart", "x"])
        with (
            mock.patch.object(make_dataset, "_call") as call,
            mock.patch.object(make_dataset, "read_drive", return_value=[]),
        ):
            make_dataset.render(spec, self.programs("exit 9"), self.folder)
        path, render = ([str(part) for part in c.args[0]] for c in call.call_args_list)
        self.assertEqual(path[1:5], ["path", "--kart", "x", "--out"])
        self.assertEqual(render[render.index("--path") + 1], path[5])

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
