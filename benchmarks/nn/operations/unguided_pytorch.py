#!/usr/bin/env python3
"""Times the published unguided network of normalized convolutions in PyTorch.

The counterpart of UnguidedNetworkPublished in operations_benchmark.cc: the same layers with random
weights at 512 x 1024. Prints the minimum and the median of the runs in milliseconds.
"""
import argparse
import statistics
import time

import torch
import torch.nn.functional as F


def normalized_convolution(x, c, weight, bias):
    padding = weight.shape[-1] // 2
    numerator = F.conv2d(x * c, weight, padding=padding)
    denominator = F.conv2d(c, weight, padding=padding)
    y = numerator / (denominator + 1e-20) + bias.view(1, -1, 1, 1)
    return y, denominator / weight.sum(dim=(1, 2, 3)).view(1, -1, 1, 1)


def pool(x, c):
    most, index = F.max_pool2d(c, 2, return_indices=True)
    best = x.flatten(2).gather(2, index.flatten(2)).view_as(most)
    return best, most / 4


def join(first, second):
    return torch.cat([first[0], second[0]], 1), torch.cat([first[1], second[1]], 1)


def up(pair):
    return tuple(F.interpolate(values, scale_factor=2, mode="nearest") for values in pair)


def unguided(pair, layers):
    n1, n2, n3, n4, n5, n6, n7 = [
        lambda values, w=w, b=b: normalized_convolution(*values, w, b) for w, b in layers]
    level0 = n3(n2(n1(pair)))
    level1 = n3(n2(pool(*level0)))
    level2 = n2(pool(*level1))
    level3 = n2(pool(*level2))
    joined = n4(join(level2, up(level3)))
    joined = n5(join(level1, up(joined)))
    return n7(n6(join(up(joined), level0)))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--height", type=int, default=512)
    parser.add_argument("--width", type=int, default=1024)
    args = parser.parse_args()
    torch.set_num_threads(args.threads)
    torch.manual_seed(0)
    shapes = [(2, 1, 5), (2, 2, 5), (2, 2, 5), (2, 4, 3), (2, 4, 3), (2, 4, 3), (1, 2, 1)]
    layers = [(torch.rand(o, i, k, k) + 0.01, torch.rand(o) - 0.5) for o, i, k in shapes]
    x = torch.rand(1, 1, args.height, args.width) * 80
    c = (torch.rand_like(x) < 0.05).float()
    times = []
    with torch.inference_mode():
        unguided((x, c), layers)
        for _ in range(args.runs):
            start = time.perf_counter()
            unguided((x, c), layers)
            times.append(1e3 * (time.perf_counter() - start))
    print(f"PyTorch {torch.__version__}, {args.threads} threads, {args.width} x {args.height}: "
          f"minimum {min(times):.1f} ms, median {statistics.median(times):.1f} ms")


if __name__ == "__main__":
    main()
