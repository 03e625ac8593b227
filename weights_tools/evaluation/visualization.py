"""Images of completed frames, and charts."""

from collections.abc import Mapping
from pathlib import Path

import cv2
import numpy as np

from weights_tools.training.shards import Frame
from weights_tools.training.sparse_points import SparsePoints

NEAREST, FARTHEST = 1.0, 80.0  # metres between the ends of the colours
WRONG = 0.3  # |ln error| of the brightest colour
_COLOURS = ((200, 90, 20), (40, 110, 230), (60, 160, 60), (160, 60, 160), (110, 110, 110))  # BGR


def write_completion(
    path: Path, frame: Frame, points: SparsePoints, depth: np.ndarray, confidence: np.ndarray
) -> None:
    """Image, points, completed and true range; error and confidence. Points are in metres."""
    known = frame.range > 0
    ratio = np.maximum(depth, 1e-3) / np.where(known, frame.range, 1)
    error = np.where(known, np.abs(np.log(ratio)), 0) / WRONG
    sparse = cv2.dilate(points.depth, np.ones((3, 3), np.uint8))  # visible
    columns = (
        (frame.rgb[:, :, ::-1], _coloured_range(sparse, sparse > 0)),
        (_coloured_range(depth, depth > 0), _coloured_range(frame.range, known)),
        (_coloured(error), _coloured(confidence)),
    )
    names = (("image", "points"), ("completed", "truth"), (f"|ln error| to {WRONG}", "confidence"))
    parts = [
        np.vstack([_labelled(*each) for each in zip(column, labels)])
        for column, labels in zip(columns, names)
    ]
    cv2.imwrite(str(path), np.hstack(parts), [cv2.IMWRITE_JPEG_QUALITY, 85])


def _coloured(fraction: np.ndarray) -> np.ndarray:
    levels = np.clip(255 * fraction, 0, 255).astype(np.uint8)
    return cv2.applyColorMap(levels, cv2.COLORMAP_VIRIDIS)


def _coloured_range(metres: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Colours of ranges: near is bright, unknown is black."""
    fraction = np.log(np.maximum(metres, NEAREST) / NEAREST) / np.log(FARTHEST / NEAREST)
    image = _coloured(1 - fraction)
    image[~known] = 0
    return image


def _labelled(image: np.ndarray, text: str) -> np.ndarray:
    image = np.ascontiguousarray(image)
    for colour, thickness in (((0, 0, 0), 4), ((255, 255, 255), 1)):
        cv2.putText(image, text, (8, 22), cv2.FONT_HERSHEY_SIMPLEX, 0.6, colour, thickness)
    return image


def write_calibration(path: Path, table: np.ndarray) -> None:
    """Draws observed over expected error; a calibrated confidence lies on the diagonal."""
    if len(table) == 0:
        return
    ends = np.array([table.min(), table.max()])
    curves = {"deciles": (table[:, 0], table[:, 1]), "as it should be": (ends, ends)}
    write_chart(path, "expected relative error", "observed relative error", curves, log_x=True)


def write_chart(
    path: Path,
    x_name: str,
    y_name: str,
    curves: Mapping[str, tuple[np.ndarray, np.ndarray]],
    log_x: bool = False,
) -> None:
    """Draws curves over a logarithmic y axis."""
    width, height, left, bottom, margin = 900, 560, 80, 60, 24
    canvas = np.full((height, width, 3), 255, np.uint8)
    xs = np.concatenate([np.asarray(x, float) for x, _ in curves.values()])
    ys = np.concatenate([np.asarray(y, float) for _, y in curves.values()])
    scales = (_Axis(xs, log_x, left, width - margin), _Axis(ys, True, height - bottom, margin))

    def text(words: str, at: tuple[int, int], colour: tuple[int, int, int] = (0, 0, 0)) -> None:
        cv2.putText(canvas, words, at, cv2.FONT_HERSHEY_SIMPLEX, 0.5, colour, 1, cv2.LINE_AA)

    for value in scales[0].ticks():
        x = scales[0].pixel(value)
        cv2.line(canvas, (x, margin), (x, height - bottom), (225, 225, 225))
        words = f"{value:.0f}" if value >= 1000 else f"{value:.3g}"
        half = 5 * len(words)  # half the width of the words, in pixels
        text(words, (min(x - half, width - 2 * half - 8), height - bottom + 20))
    for value in scales[1].ticks():
        y = scales[1].pixel(value)
        cv2.line(canvas, (left, y), (width - margin, y), (225, 225, 225))
        text(f"{value:.3g}", (8, y + 5))
    text(x_name, (width // 2 - 60, height - 12))
    text(y_name, (8, margin - 8))
    for i, (name, (x, y)) in enumerate(curves.items()):
        colour = _COLOURS[i % len(_COLOURS)]
        points = [(scales[0].pixel(a), scales[1].pixel(b)) for a, b in zip(x, y)]
        cv2.polylines(canvas, [np.array(points)], False, colour, 2, cv2.LINE_AA)
        text(name, (width - 250, margin + 22 * (i + 1)), colour)
    cv2.imwrite(str(path), canvas)


class _Axis:
    """Maps values to pixels from `first` to `last`."""

    def __init__(self, values: np.ndarray, is_log: bool, first: int, last: int) -> None:
        values = values[np.isfinite(values) & ((values > 0) | (not is_log))]
        low, high = (values.min(), values.max()) if len(values) else (1.0, 2.0)
        self._is_log, self._first, self._last = is_log, first, last
        self._low, self._high = self._place(low), self._place(high)
        if self._high - self._low < 1e-9:
            self._high = self._low + 1

    def _place(self, value: float) -> float:
        return float(np.log(max(value, 1e-12)) if self._is_log else value)

    def pixel(self, value: float) -> int:
        fraction = (self._place(value) - self._low) / (self._high - self._low)
        position = float(np.clip(fraction, -0.02, 1.02))
        return round(self._first + position * (self._last - self._first))

    def ticks(self) -> np.ndarray:
        places = np.linspace(self._low, self._high, 6)
        return np.exp(places) if self._is_log else places
