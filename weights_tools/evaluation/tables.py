"""Results as tables in Markdown."""

from collections.abc import Sequence

from weights_tools.evaluation.depth_errors import LATITUDE_BANDS, RANGE_ENDS, DepthErrors
from weights_tools.evaluation.results import (
    HEADLINE,
    METHODS,
    OURS,
    Result,
    calibration_table,
    risk_coverage,
)


def print_tables(results: dict[str, Result], total: Result) -> None:
    def table(title: str, heads: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
        print(f"\n{title}\n")
        print("| " + " | ".join(heads) + " |")
        print("|---" + "|---:" * (len(heads) - 1) + "|")
        for row in rows:
            print("| " + " | ".join(row) + " |")

    everything = {**results, "all": total}
    keys = list(total.summary())
    rows = [[name, *(f"{r.summary()[key]:.3f}" for key in keys)] for name, r in everything.items()]
    table("Headline (500 to 2,000 points)", ["", *keys], rows)
    of_all = {points for result in results.values() for _, points in result.errors}
    counts = sorted(of_all, key=lambda kind: (not kind.isdigit(), len(kind), kind))
    rows = [
        [name, *(_cell(result, count) for count in counts)] for name, result in everything.items()
    ]
    heads = ["", *(f"{count} points" for count in counts)]
    table(f"absrel by world: {OURS} / best classical method, and the ratio within 1.25", heads, rows)
    for key in ("absrel", "delta1", "rmse", "mae", "irmse", "imae"):
        rows = [
            [method, *(f"{total.of(method, count).measures()[key]:.3f}" for count in counts)]
            for method in METHODS
        ]
        table(f"{key} by number of points", ["", *map(str, counts)], rows)
    sums = {method: DepthErrors() for method in METHODS}
    for (method, count), errors in total.errors.items():
        if count in HEADLINE:
            sums[method] += errors
    heads = [f"to {end:g} m" for end in RANGE_ENDS]
    bands = [f"{180 * i / LATITUDE_BANDS - 90:g}°" for i in range(LATITUDE_BANDS)]
    for key in ("absrel", "delta1", "rmse", "mae", "irmse", "imae"):
        by_range, by_band = (
            [
                [method, *(f"{sums[method].measures(**{axis: i})[key]:.3f}" for i in range(count))]
                for method in METHODS
            ]
            for axis, count in (("range_bin", len(RANGE_ENDS)), ("band", LATITUDE_BANDS))
        )
        table(f"{key} by range", ["", *heads], by_range)
        table(f"{key} by latitude, from 30° below to the poles", ["", *bands], by_band)
    rows = [
        [f"{i + 1}", f"{expected:.4f}", f"{observed:.4f}"]
        for i, (expected, observed) in enumerate(calibration_table(total))
    ]
    table("Calibration: relative error by decile", ["decile", "expected", "observed"], rows)
    rows = [[f"{100 * covered:.0f} %", f"{risk:.4f}"] for covered, risk in risk_coverage(total)]
    table("Risk and coverage: mean relative error of the most confident", ["covered", "risk"], rows)


def _cell(result: Result, points: str) -> str:
    own = result.of(OURS, points).measures()
    if own["absrel"] != own["absrel"]:
        return "–"
    return f"{own['absrel']:.3f} / {result.best_classical([points]):.3f}, {own['delta1']:.3f}"
