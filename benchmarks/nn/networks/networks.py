#!/usr/bin/python3
"""Times whole networks beside PyTorch: both take turns on the same threads; times are medians.

From the root of the project: python3 -m benchmarks.nn.networks.networks --help
"""

import argparse
import contextlib
import dataclasses
import json
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import torch

from weights_tools.builder import Description
from weights_tools.export import export
from weights_tools.network import Network
from weights_tools.networks import NETWORKS

RUNNER = Path("build/nn_network_runner")
RUNS_IN_A_TURN = 3


def cut(whole: Description, known: Sequence[str], outputs: Sequence[str], name: str) -> Description:
    """The part of a network that computes the tensors `outputs` if the tensors `known` are given, and
    what it needs of the network's own inputs."""
    needed, nodes = set(outputs) - set(known), []
    for node in reversed(whole.graph.nodes):
        if needed.isdisjoint(node.outputs):
            continue
        needed -= set(node.outputs)
        needed |= set(node.inputs) - set(known)
        nodes.insert(0, node)
    own = [port for port in whole.graph.inputs if port["name"] in needed]
    names = {weight.rsplit(".", 1)[0] for node in nodes for weight in node.weights.values()}
    graph = dataclasses.replace(
        whole.graph,
        name=name,
        inputs=[{"name": tensor, "channels": 1} for tensor in known] + own,
        nodes=nodes,
        outputs=[{"name": tensor, "tensor": tensor} for tensor in outputs],
    )
    layers = [layer for layer in whole.layers if layer.name in names]
    return Description(graph, layers, [cost for cost in whole.costs if cost.node in names])


def networks() -> dict[str, Description]:
    coarse = NETWORKS["coarse_depth_completion"]()
    propagated = ["propagated", "propagated.c"]
    return {
        "unguided": NETWORKS["unguided"](),
        "propagation": cut(coarse, [], propagated, "seven levels"),
        "fusion": cut(coarse, propagated, ["completed", "completed.c"], "fusion"),
        "coarse": coarse,
        "completion": NETWORKS["depth_completion"](),
        "encoder-decoder": NETWORKS["encoder_decoder"](),
    }


@contextlib.contextmanager
def runner(file: Path, height: int, threads: int, precision: str):
    """What the project's library says of the network, and a function that runs it: milliseconds."""
    command = [RUNNER, file, "--height", height, "--threads", threads, "--precision", precision]
    process = subprocess.Popen(
        [str(part) for part in command], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    )

    def run() -> float:
        process.stdin.write("\n")
        process.stdin.flush()
        return float(process.stdout.readline())

    try:
        yield json.loads(process.stdout.readline()), run
    finally:
        process.stdin.close()
        process.wait()


def pytorch(network: Network, height: int) -> Callable[[], float]:
    generator = torch.Generator().manual_seed(1)
    size = (height, 2 * height)
    known = torch.rand((1, 1, *size), generator=generator) < 0.005
    inputs = {}
    for port in network.description.graph.inputs:
        values = 0.01 + torch.rand((1, port["channels"], *size), generator=generator)
        sparse = port["name"] in ("depth", "confidence")
        inputs[port["name"]] = torch.where(known, values, 0.0) if sparse else values

    def run() -> float:
        with torch.inference_mode():
            start = time.perf_counter()
            network(inputs)
            return 1e3 * (time.perf_counter() - start)

    return run


def measure(description: Description, arguments: argparse.Namespace) -> dict[str, float]:
    """Medians in milliseconds by who ran it, and what the runner says of the network in floats."""
    network = Network(description)
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        file = Path(folder) / "network.h5"
        export(file, network, {}, np.float16)
        contenders = {"PyTorch": pytorch(network, arguments.height)}
        for precision in arguments.precision:
            about, contenders[precision] = stack.enter_context(
                runner(file, arguments.height, arguments.threads, precision)
            )
            if precision == "float":
                facts = about
        times = {contender: [] for contender in contenders}
        for _ in range(arguments.turns):
            for contender, run in contenders.items():
                run()  # not counted: what ran before has taken the caches
                times[contender] += [run() for _ in range(RUNS_IN_A_TURN)]
                time.sleep(0.002)  # OpenMP's threads wait busily for a while after their work
    return facts | {contender: statistics.median(values) for contender, values in times.items()}


def row(name: str, result: dict[str, float]) -> str:
    bf16 = f"{result['bf16']:6.1f} ms" if "bf16" in result else ""
    return (
        f"{name:16} {result['load_ms']:5.1f} ms {result['pack_ms']:5.1f} ms "
        f"{result['planned_mb']:6.1f} MB {result['float']:6.1f} ms {bf16:>9} "
        f"{result['PyTorch']:6.1f} ms {result['float'] / result['PyTorch']:7.3f}"
    )


def summary(results: dict[str, dict[str, float]]) -> dict[str, float]:
    keys = {"completion": "network", "fusion": "fusion", "unguided": "unguided"}
    ratios = {
        f"{key}_vs_pytorch": results[name]["float"] / results[name]["PyTorch"]
        for name, key in keys.items()
        if name in results
    }
    if "completion" not in results:
        return ratios
    whole = results["completion"]
    figures = {
        "network_ms": whole["float"],
        "network_memory_mb": whole["planned_mb"],
        "network_load_ms": whole["load_ms"] + whole["pack_ms"],
    }
    if "bf16" in whole:
        figures["network_bf16_ms"] = whole["bf16"]
    return figures | ratios


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--height", type=int, default=512, help="of the panorama (default: 512)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--turns", type=int, default=10, help="three runs each (default: 10)")
    parser.add_argument("--network", nargs="+", default=list(networks()), choices=networks())
    parser.add_argument("--float-only", action="store_true", help="for processors without bfloat16")
    parser.add_argument("--json", action="store_true", help="print only the summary, as JSON")
    parser.add_argument("--onto", type=argparse.FileType(), help="JSON to add the summary to")
    arguments = parser.parse_args()
    arguments.precision = ["float"] if arguments.float_only else ["float", "bf16"]
    torch.set_num_threads(arguments.threads)

    results = {}
    if not arguments.json:
        print(
            f"{'network':16} {'load':>8} {'pack':>8} {'memory':>9} "
            f"{'float':>9} {'bf16':>9} {'PyTorch':>9} {'ratio':>7}"
        )
    descriptions = networks()
    for name in arguments.network:
        results[name] = measure(descriptions[name], arguments)
        if not arguments.json:
            print(row(name, results[name]), flush=True)
    if arguments.json:
        before = json.load(arguments.onto) if arguments.onto else {}
        print(json.dumps(before | summary(results), indent=2))


if __name__ == "__main__":
    main()
