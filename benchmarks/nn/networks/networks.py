#!/usr/bin/python3
"""Times whole networks beside PyTorch and ONNX Runtime, which take turns on the same threads, and beside
the least time that the machine allows.

From the root of the project: python3 -m benchmarks.nn.networks.networks --help
"""

import argparse
import contextlib
import dataclasses
import json
import math
import statistics
import subprocess
import tempfile
import time
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import torch

from benchmarks.nn.networks import onnx_network
from weights_tools import network_file
from weights_tools.builder import Description
from weights_tools.export import export
from weights_tools.graph import Graph, run
from weights_tools.network import Network
from weights_tools.networks import NETWORKS

RELEASED = Path("weights/depth_completion.h5")
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


@dataclasses.dataclass(frozen=True)
class Subject:
    """A network as it is measured."""

    graph: Graph
    weights: dict[str, torch.Tensor]
    file: Path
    has_ranges: bool = False  # and so can multiply in 8-bit integers


def untrained(description: Description, file: Path) -> Subject:
    network = Network(description)
    export(file, network, {}, np.float16)
    weights = {name: value.detach() for name, value in network.weights().items()}
    return Subject(description.graph, weights, file)


def released() -> Subject:
    graph, stored = network_file.read(RELEASED)
    weights = {name: torch.as_tensor(values).float() for name, values in stored.items()}
    return Subject(graph, weights, RELEASED, bool(network_file.read_ranges(RELEASED)))


@contextlib.contextmanager
def program(*command: object):
    """The line with which a program begins, and a function that lets it run once: milliseconds."""
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


def random_inputs(graph: Graph, height: int) -> dict[str, torch.Tensor]:
    generator = torch.Generator().manual_seed(1)
    size = (height, 2 * height)
    known = torch.rand((1, 1, *size), generator=generator) < 0.005
    inputs = {}
    for port in graph.inputs:
        values = 0.01 + torch.rand((1, port["channels"], *size), generator=generator)
        sparse = port["name"] in ("depth", "confidence")
        inputs[port["name"]] = torch.where(known, values, 0.0) if sparse else values
    return inputs


def pytorch(subject: Subject, height: int) -> Callable[[], float]:
    inputs = random_inputs(subject.graph, height)

    def once() -> float:
        with torch.inference_mode():
            start = time.perf_counter()
            run(subject.graph, subject.weights, inputs)
            return 1e3 * (time.perf_counter() - start)

    return once


def onnx_command(subject: Subject, model: Path, arguments: argparse.Namespace) -> list[object]:
    onnx_network.export(
        model, subject.graph, subject.weights, random_inputs(subject.graph, arguments.height)
    )
    runner = arguments.programs / "nn_onnx_runner"
    command = [runner, model, "--onnxruntime", arguments.onnxruntime]
    for port in subject.graph.inputs:
        command += ["--input", f"{port['name']}={port['channels']}"]
    command += ["--outputs", len(subject.graph.outputs)]
    return command + ["--height", arguments.height, "--threads", arguments.threads]


def measure(subject: Subject, arguments: argparse.Namespace) -> dict[str, Any]:
    """Medians in milliseconds by who ran it (minima with --best), what the runner says of the network
    in floats, and what each type multiplies (`work`)."""
    own = [arguments.programs / "nn_network_runner", subject.file]
    own += ["--height", arguments.height, "--threads", arguments.threads]
    work = {}
    with tempfile.TemporaryDirectory() as folder, contextlib.ExitStack() as stack:
        contenders = {} if arguments.best else {"PyTorch": pytorch(subject, arguments.height)}
        if arguments.onnxruntime:
            command = onnx_command(subject, Path(folder) / "model.onnx", arguments)
            _, contenders["ONNX Runtime"] = stack.enter_context(program(*command))
        for precision in arguments.precision:
            if precision == "int8" and not subject.has_ranges:
                continue
            about, contenders[precision] = stack.enter_context(
                program(*own, "--precision", precision)
            )
            work[precision] = about["work"]
            if precision == "float":
                facts = about
        for device in arguments.device:
            about, once = stack.enter_context(program(*own, "--device", device))
            if about["device"] != "cpu":  # `auto` where there is no GPU
                contenders[about["device"].split()[0]] = once
        times = {contender: [] for contender in contenders}
        for _ in range(arguments.turns):
            for contender, once in contenders.items():
                once()  # not counted: what ran before has taken the caches
                times[contender] += [once() for _ in range(RUNS_IN_A_TURN)]
                time.sleep(0.002)  # OpenMP's threads wait busily for a while after their work
    typical = min if arguments.best else statistics.median
    results = {contender: typical(values) for contender, values in times.items()}
    return facts | {"work": work, "times": results}


def floor(work: Mapping[str, Any], peaks: Mapping[str, float]) -> float:
    """The least time in milliseconds: all products at the peak of their type and after them all bytes
    that nodes read and write at the memory's bandwidth."""
    products = sum(2 * count / peaks[kind] for kind, count in work["products"].items())
    return 1e3 * (products + work["gigabytes"] / peaks["bandwidth"])


def _text(ratio: float, width: int) -> str:
    return " " * width if math.isnan(ratio) else f"{ratio:{width}.2f}"


def rows(name: str, height: int, result: Mapping[str, Any], peaks: Mapping[str, float]) -> list[str]:
    """A line for everyone who ran the network."""
    lines = []
    times, slowest = result["times"], result["times"].get("ONNX Runtime", float("nan"))
    for contender, taken in times.items():
        line = f"{name:16} {height:5} {contender:13} {taken:8.2f} ms {_text(slowest / taken, 7)}"
        if contender in result["work"]:
            least = floor(result["work"][contender], peaks)
            line += f" {least:8.2f} ms {taken / least:7.2f}"
        lines.append(line)
    lines.append(
        f"{'':16} load {result['load_ms']:.0f} ms, pack {result['pack_ms']:.0f} ms, "
        f"memory {result['planned_mb']:.1f} MB"
    )
    return lines


def summary(results: Mapping[str, Mapping[str, Any]]) -> dict[str, float]:
    keys = {"completion": "network", "fusion": "fusion", "unguided": "unguided"}
    ratios = {
        f"{key}_vs_pytorch": results[name]["times"]["float"] / results[name]["times"]["PyTorch"]
        for name, key in keys.items()
        if name in results and "PyTorch" in results[name]["times"]
    }
    if "completion" not in results:
        return ratios
    whole = results["completion"]
    figures = {
        "network_ms": whole["times"]["float"],
        "network_memory_mb": whole["planned_mb"],
        "network_load_ms": whole["load_ms"] + whole["pack_ms"],
    }
    for precision in ("bf16", "int8"):
        if precision in whole["times"]:
            figures[f"network_{precision}_ms"] = whole["times"][precision]
    return figures | ratios


def precisions() -> list[str]:
    """What this processor multiplies in."""
    info = Path("/proc/cpuinfo")
    flags = set(info.read_text().split()) if info.exists() else set()
    units = {"bf16": "avx512_bf16", "int8": "avx512_vnni"}
    return ["float", *(name for name, flag in units.items() if flag in flags)]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    descriptions = networks()
    parser.add_argument("--height", type=int, default=512, help="of the panorama (default: 512)")
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--turns", type=int, default=10, help="three runs each (default: 10)")
    parser.add_argument("--network", nargs="+", default=[*descriptions, "released"],
                        choices=[*descriptions, "released"])  # fmt: skip
    parser.add_argument("--float-only", action="store_true", help="no bfloat16, no 8-bit integers")
    parser.add_argument("--onnxruntime", type=Path, help="path of libonnxruntime.so")
    parser.add_argument("--device", nargs="*", default=[], help="others than the CPU: vulkan:0, or auto ...")
    parser.add_argument("--best", action="store_true",
                        help="minima, for a busy machine, and without PyTorch")  # fmt: skip
    parser.add_argument("--programs", type=Path, default=Path("build"), help="folder of the runners")
    parser.add_argument("--json", action="store_true", help="print only the summary, as JSON")
    parser.add_argument("--onto", type=argparse.FileType(), help="JSON to add the summary to")
    arguments = parser.parse_args()
    arguments.precision = ["float"] if arguments.float_only else precisions()
    torch.set_num_threads(arguments.threads)

    results = {}
    peaks = measure_peaks(arguments)
    if not arguments.json:
        print("peaks: " + ", ".join(f"{key} {value:.1f}" for key, value in peaks.items()), flush=True)
        print(f"{'network':16} {'rows':>5} {'who':13} {'time':>11} {'/ORT':>7} {'floor':>11} "
              f"{'/floor':>7}")  # fmt: skip
    with tempfile.TemporaryDirectory() as folder:
        for name in arguments.network:
            file = Path(folder) / f"{name}.h5"
            subject = released() if name == "released" else untrained(descriptions[name], file)
            results[name] = measure(subject, arguments)
            if not arguments.json:
                print("\n".join(rows(name, arguments.height, results[name], peaks)), flush=True)
    if arguments.json:
        before = json.load(arguments.onto) if arguments.onto else {}
        print(json.dumps(before | summary(results), indent=2))


def measure_peaks(arguments: argparse.Namespace) -> dict[str, float]:
    """10^9 operations a second by type, and bytes of memory."""
    command = [arguments.programs / "nn_benchmarks", "--peaks", "--threads", str(arguments.threads)]
    return json.loads(subprocess.run(command, check=True, stdout=subprocess.PIPE).stdout)


if __name__ == "__main__":
    main()
