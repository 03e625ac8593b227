"""The scripts do what the documents say, in a short form."""

import json
import os
import subprocess
import tempfile
import unittest
from pathlib import Path

import cv2
import numpy as np

from shell_blocks import ROOT

BUILD = Path(os.environ.get("ORB360_BINARY_DIR", ROOT / "build"))


class Scripts(unittest.TestCase):
    @classmethod
    def setUpClass(cls) -> None:
        cache = tempfile.TemporaryDirectory(dir=BUILD)  # towns, which are rendered once
        cls.addClassCleanup(cache.cleanup)
        cls.cache = Path(cache.name)

    def setUp(self) -> None:
        folder = tempfile.TemporaryDirectory(dir=BUILD)
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def run_script(self, name: str, *arguments: object) -> str:
        done = subprocess.run([str(ROOT / "scripts" / name), *map(str, arguments)], check=False,
                              text=True, cwd=self.folder, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:] + done.stdout[-2000:])
        return done.stdout

    def render(self, frames: int, *options: str) -> Path:
        town = self.folder / "town"
        subprocess.run([BUILD / "town", "render", "--town", "7", "--frames", str(frames), "--width",
                        "512", "--out", town, *options], check=True, stdout=subprocess.DEVNULL)
        return town

    def test_evaluate_prints_json_and_nothing_else(self) -> None:
        results = json.loads(self.run_script(
            "evaluate", "--json", "--skip-build", "--towns", "Loop", "--frames", 60, "--width", 512,
            "--variants", "tri", "--cache", self.cache, "--out", self.folder / "out"))
        self.assertEqual([r["tracked"] for r in results], [60])
        self.assertAlmostEqual(results[0]["scale_factor"], 1.0, delta=0.05)

    def test_evaluate_prints_a_table_with_a_row_for_each_run(self) -> None:
        table = self.run_script(
            "evaluate", "--skip-build", "--towns", "Loop", "--frames", 60, "--width", 512,
            "--cache", self.cache, "--out", self.folder / "out")
        for variant in ("mono", "tri", "dc"):
            self.assertRegex(table, rf"Loop \| +{variant} \| +60/60 \| +0 \|")

    def test_draw_mesh_shows_the_surfaces_around_a_keyframe(self) -> None:
        town = self.render(40)
        run = self.folder / "run"
        subprocess.run([BUILD / "orb360", "run", town, "--mask", "none", "--mesh", "--quiet",
                        "--out", run], check=True)
        for options in ((), ("--colour",)):
            self.run_script("draw_mesh", run, "mesh.png", "--keyframe", 2, "--size", 320, 180,
                            *options)
            image = cv2.imread(str(self.folder / "mesh.png"))
            self.assertEqual(image.shape, (180, 320, 3))
            self.assertGreater(np.mean(image[120:].max(axis=2) > 0), 0.5)  # the road
        refused = subprocess.run([ROOT / "scripts" / "draw_mesh", self.folder, "mesh.png"],
                                 check=False, text=True, stderr=subprocess.PIPE)
        self.assertNotEqual(refused.returncode, 0)
        self.assertRegex(refused.stderr, r"^[^\n]*mesh.ply: is missing[^\n]*\n$")

    def test_evaluate_outside_measures_every_recording_below_a_folder(self) -> None:
        town = self.render(60, "--depth-every", "10")
        (self.folder / "no_recording").mkdir()
        (self.folder / "no_recording" / "sequence.yaml").write_text("fps: 10\n")
        short = ("evaluate", "--outside", self.folder, "--skip-build", "--out",
                 self.folder / "out")
        results = json.loads(self.run_script(*short, "--json"))
        self.assertEqual([(r["sequence"], r["variant"], r["tracked"]) for r in results],
                         [(town.name, "tri", 60), (town.name, "dc", 60)])
        for result in results:
            self.assertFalse(result["scale"]["assumed_height"])
            self.assertGreater(result["frame_ms_p95"], 0.0)
            local = result["local_scale"]  # 60 frames are about 30 m.
            self.assertGreater(local["windows"], 0)
            self.assertLessEqual(local["min"], local["max"])
            self.assertAlmostEqual(local["min"], 1.0, delta=0.1)
            self.assertIsNone(local["drift_median_per_100m"])
        self.assertNotIn("cloud_accuracy_10cm", results[0])
        self.assertGreater(results[1]["cloud_accuracy_25cm"], 0.1)
        # The table has the same runs, which are not made again.
        table = self.run_script(*short)
        for variant in ("tri", "dc"):
            self.assertRegex(table, rf"town \| +{variant} \| +60/60 \| +0 \|.* metric ± 2")
        short_form = json.loads(self.run_script(*short, "--json", "--variants", "tri",
                                                "--max-frames", 20))
        self.assertEqual([r["tracked"] for r in short_form], [20])

    def test_evaluate_outside_refuses_a_folder_without_recordings(self) -> None:
        done = subprocess.run([str(ROOT / "scripts" / "evaluate"), "--skip-build", "--outside",
                               str(self.folder)], check=False, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE)
        self.assertEqual(done.returncode, 1)
        self.assertRegex(done.stderr, r"^evaluate: .*: no folder below has sequence.yaml.*\n$")

    def test_bench_prints_json_and_nothing_else(self) -> None:
        figures = json.loads(self.run_script("bench", "--quick", "--json", "--skip-build"))
        for key in ("network_vs_pytorch", "fusion_vs_pytorch", "unguided_vs_pytorch"):
            self.assertGreater(figures[key], 0.0)

    def test_camera_effects_have_their_own_truth(self) -> None:
        town = self.render(60, "--depth-every", "10")

        def run(effect: str, *options: object) -> dict:
            out = self.folder / effect
            self.run_script("camera_effects", effect, town, "--out", out, *options)
            result = json.loads(self.run_script(
                "evaluate", "--outside", out, "--skip-build", "--json", "--variants", "tri",
                "--out", self.folder / "out"))[0]
            self.assertEqual(result["tracked"], 60)
            self.assertLess(result["ate_rmse_sim3"], 0.2)
            return result

        for effect in ("exposure", "lock"):
            with self.subTest(effect):
                run(effect)
        self.assertEqual(len(list((self.folder / "lock" / "depth").iterdir())), 6)
        # Poses of `lock` are level and all look along the world's x axis.
        row = (self.folder / "lock" / "groundtruth.txt").read_text().splitlines()[20].split()
        self.assertEqual([abs(round(float(x), 6)) for x in row[4:]], [0.5] * 4)
        # Lenses apart shorten each step, unless the run finds their distance.
        result = run("seam", "--lens-distance", 0.1)
        self.assertAlmostEqual(result["scale"]["lens_distance"], 0.1, delta=0.02)
        self.assertAlmostEqual(result["scale_factor"], 1.0, delta=0.03)

    def test_camera_effects_refuse_what_is_no_recording(self) -> None:
        recording = self.folder / "recording"

        def refused() -> str:
            done = subprocess.run([str(ROOT / "scripts" / "camera_effects"), "level",
                                   str(recording), "--out", str(self.folder / "x")], check=False,
                                  text=True, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            self.assertEqual(done.returncode, 1)
            return done.stderr

        self.assertRegex(refused(), r"^camera_effects: .*is .* a recording\?\n$")
        recording.mkdir()
        (recording / "sequence.yaml").write_text("camera_height: 1.6\n")
        (recording / "groundtruth.txt").write_text("0 1 2 three\n")
        self.assertRegex(refused(), r"^camera_effects: .*groundtruth.txt: .*three.*\n$")
        (recording / "groundtruth.txt").write_text("0 0 0 0 0 0 0 1\n")
        self.assertRegex(refused(), r"^camera_effects: .* has 0 images and 1 poses\n$")
        (recording / "rgb").mkdir()
        (recording / "rgb" / "000000.jpg").write_text("no image")
        self.assertRegex(refused(), r"^camera_effects: .*000000.jpg is no image\n$")

    def test_kidnap_counts_every_try(self) -> None:
        printed = self.run_script("kidnap", self.render(60), "--out", self.folder / "kidnap",
                                  "--tries", 2, "--orb360", BUILD / "orb360")
        self.assertRegex(printed, r"2 tries, \d located, \d right")

    def test_digests_of_two_runs_agree(self) -> None:
        short = ("--build", BUILD, "--towns", "Loop", "--variants", "sparse", "--frames", 60,
                 "--cache", self.cache)
        digests = self.folder / "digests.json"
        self.run_script("digests", *short, "--out", digests)
        self.run_script("digests", *short, "--compare", digests)


if __name__ == "__main__":
    unittest.main()
