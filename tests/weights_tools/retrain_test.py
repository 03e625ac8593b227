"""The whole pipeline, from shards to weights, in a few steps."""

import contextlib
import io
import tempfile
import unittest
from dataclasses import replace
from pathlib import Path
from unittest import mock

import cv2
import numpy as np
import torch

from tests.weights_tools import drives
from weights_tools import network_file
from weights_tools.training import retrain, shards
from weights_tools.training.worlds import RESERVED
from weights_tools.training.shards import Frame


def doubled(frame: Frame) -> Frame:
    def grow(image: np.ndarray) -> np.ndarray:
        return image.repeat(2, axis=0).repeat(2, axis=1)

    features = frame.features * [2, 2, 1]
    images = {name: grow(getattr(frame, name)) for name in ("rgb", "range", "moving", "ground")}
    return replace(frame, features=features, **images)


class RetrainTest(unittest.TestCase):
    def test_both_networks_are_trained_in_stages_and_written(self) -> None:
        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        self.addCleanup(torch.set_num_threads, threads)
        with tempfile.TemporaryDirectory() as temporary:
            out = Path(temporary)
            for part in ("training", "validation"):
                small = drives.frame()
                frames = {"quarter": small, "half": doubled(small), "full": doubled(doubled(small))}
                for size, frame in frames.items():
                    path = out / "shards" / part / size / "street.npz"
                    path.parent.mkdir(parents=True)
                    shards.write(path, shards.pack([frame]))
            with contextlib.redirect_stdout(io.StringIO()):
                for _ in range(2):  # the second time nothing is left to do
                    retrain.train_all(out, out / "shards", 1e-4, torch.device("cpu"))
                    times = {path: path.stat().st_mtime_ns for path in out.glob("*/log.csv")}
                self.assertEqual(len(times), 7)
            retrain.release(out)
            for name, network, halvings, stages in (
                ("depth_completion", "ours", 0, 3),
                ("encoder_decoder", "published", 1, 2),
            ):
                graph, _ = network_file.read(out / f"{name}.h5")
                self.assertEqual(graph.normalisation["width"], 4 * drives.WIDTH >> halvings)
                self.assertEqual(graph.provenance["network"], name)
                self.assertEqual(len(graph.provenance["earlier"]), stages)
                self.assertIsNotNone(cv2.imread(str(out / f"learning_curve_{network}.png")))

    def test_without_shards_it_says_so(self) -> None:
        with tempfile.TemporaryDirectory() as out:
            with self.assertRaisesRegex(ValueError, "has no shards to train on"):
                retrain.train_all(Path(out), Path(out), 1, torch.device("cpu"))

    def test_what_is_validated_on_is_not_trained_on(self) -> None:
        made = {}
        with mock.patch.object(
            retrain.make_dataset, "make_all", lambda specs, _, out: made.update({out.name: specs})
        ):
            files = [Path("forza.acc")], [Path("zengarden")], [Path("oa_dm1.bsp")]
            retrain.render_all(Path("out"), None, *files)
        training, validation = ({s.name for s in made[n]} for n in ("training", "validation"))
        self.assertFalse(training & validation)
        self.assertLess({"forza", "kart-zengarden", "map-oa_dm1-0", "interior100", "landscape100", "tunnel139"}, training)
        self.assertEqual(sum(spec.is_tracked for spec in made["training"]), 8)
        for name in RESERVED:
            for option in ("circuits", "karts", "maps"):
                with self.assertRaisesRegex(ValueError, "kept for measurements"):
                    retrain.render_all(Path("out"), None, **{option: [Path(name)]})


if __name__ == "__main__":
    unittest.main()
