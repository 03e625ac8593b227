"""Networks without some of their parts."""

import contextlib
import io
import tempfile
import unittest
from pathlib import Path

import torch

from tests.weights_tools import drives
from weights_tools import networks
from weights_tools.ablation import without
from weights_tools.network import Network
from weights_tools.training import ablate, shards
from weights_tools.training.train import Settings


def description() -> networks.Description:
    return networks.coarse_depth_completion((4, 4, 6, 6, 8), 10)


def inputs() -> dict[str, torch.Tensor]:
    torch.manual_seed(1)
    return {
        "image": torch.rand(1, 3, 64, 128),
        "depth": torch.rand(1, 1, 64, 128) + 1,
        "confidence": (torch.rand(1, 1, 64, 128) < 0.1).float(),
    }


class WithoutTest(unittest.TestCase):
    def test_an_input_that_counts_nothing_is_an_input_of_zeros(self) -> None:
        whole, blind = Network(description()), Network(without(description(), ["image"]))
        seen, dark = inputs(), {**inputs(), "image": torch.zeros(1, 3, 64, 128)}
        for name, values in whole(dark).items():
            self.assertTrue(torch.equal(blind(seen)[name], values), name)
        self.assertFalse(torch.equal(whole(seen)["log_depth"], whole(dark)["log_depth"]))

    def test_what_reads_the_result_of_a_node_reads_zeros(self) -> None:
        tensors = Network(without(description(), ["trust", "propagated"])).tensors(inputs())
        self.assertTrue(torch.equal(tensors["coarse"], tensors["own"]))
        self.assertEqual(tensors["features"][:, 0].abs().max().item(), 0.0)
        self.assertGreater(tensors["propagated"].abs().max().item(), 0.0)

    def test_an_unknown_tensor_is_refused(self) -> None:
        with self.assertRaisesRegex(ValueError, 'has no tensor "imaeg"'):
            without(description(), ["image", "imaeg"])


class AblateTest(unittest.TestCase):
    def test_a_variant_needs_fewer_products_where_layers_lead_nowhere(self) -> None:
        whole = ablate.products("")
        for name, zeroed in ablate.VARIANTS.items():
            self.assertLessEqual(ablate.products(zeroed), whole, name)
        self.assertLess(ablate.products(ablate.VARIANTS["without residual blocks"]), 0.7 * whole)
        self.assertEqual(ablate.products(ablate.VARIANTS["without the image"]), whole)

    def test_all_variants_are_trained_measured_and_printed(self) -> None:
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            shard = folder / "street.npz"
            shards.write(shard, shards.pack([drives.frame()]))
            settings = Settings(
                network=ablate.NETWORK, steps=1, batch=1, warm_up=1, fixed_propagation=True,
                batch_normalization=True,
            )  # fmt: skip
            said = io.StringIO()
            chosen = ["complete", "without the image", "normals as a second task"]
            with contextlib.redirect_stdout(said):
                ablate.ablate(folder / "out", settings, [shard], [shard], chosen=chosen)
            with contextlib.redirect_stdout(io.StringIO()):
                start = folder / "out" / "variant0" / "checkpoint.pt"
                ablate.ablate(folder / "more", settings, [shard], [shard], start, ["complete"])
            self.assertEqual([path.name for path in (folder / "more").iterdir()], ["variant0"])
            stages = torch.load(folder / "more" / "variant0" / "checkpoint.pt")["stages"]
            self.assertEqual(stages[-1]["network"], ablate.NETWORK)
            table = said.getvalue().split("\n\n")[1].splitlines()
            self.assertEqual(len(table), 5)
            self.assertRegex(table[4], r"^\| normals as a second task \| \d\.\d+ ")
            self.assertRegex(table[3], r"^\| without the image \| \d\.\d+ \| \d\.\d+ \| \d\.\d+ \| \d+ \|$")


if __name__ == "__main__":
    unittest.main()
