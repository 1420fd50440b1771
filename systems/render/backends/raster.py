"""Raster: draws strokes, areas and discs into the pixels of a picture by compiled kernels, and few strokes by numpy.

While a hand drags a joint of a frame of 104 members, its diagrams and arrows are filled in 0.3 ms in place of 1.8.
"""

from __future__ import annotations

import inspect
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pinjoint.systems.program.compiler import GeneratedModule
from pinjoint.systems.render.backends import kernels
from pinjoint.systems.render.backends.kernels import BLOCK
from pinjoint.systems.render.marks import Bars, Discs, Fills, Points, Strokes

Pixels = NDArray[np.uint32]
Clip = tuple[int, int, int, int]

# The kernels of kernels.py that are compiled, with their types.
_POINTS, _CLIP, _PIXELS = "float64[:, ::1]", "UniTuple(int64, 4)", "uint32[:, ::1]"
_FARTHEST = 1e9  # pixels of corners, which 64 bits can tell along any edge
_COVER = "uint8[:, ::1], uint8[:, ::1]"
SIGNATURES = {
    "draw_strokes": f"void({_PIXELS}, {_COVER}, {_CLIP}, {_POINTS}, {_POINTS}, float64, uint32, int64)",
    "fill_polygons": f"void({_PIXELS}, {_CLIP}, int64[:, :, ::1], uint32, int64)",
    "draw_bars": f"void({_PIXELS}, {_CLIP}, {_POINTS}, {_POINTS}, {_POINTS}, uint32, int64)",
    "draw_discs": f"void({_PIXELS}, {_CLIP}, {_POINTS}, float64[::1], float64, uint32, int64, uint32, int64)",
}


class Raster:
    """The kernels and their scratch, for surfaces of any size.

    Pixels are (rows, columns); a clip is left, top, right, bottom. Colours are pixels of the surface.
    """

    def __init__(self, compiled: Any) -> None:
        """compiled: those of kernels.py."""
        self._kernels = compiled
        self._prepare((0, 0))

    def _prepare(self, shape: tuple[int, int]) -> None:
        """Allocate the coverage of each pixel, and the flags of covered blocks; rows consist of whole blocks."""
        self._shape = shape
        self._touched = np.zeros((shape[0], -(-shape[1] // BLOCK)), dtype=np.uint8)
        self._cover = np.zeros((shape[0], BLOCK * self._touched.shape[1]), dtype=np.uint8)

    def strokes(self, pixels: Pixels, clip: Clip, mark: Strokes, colour: np.uint32) -> None:
        """Blend strokes; each pixel by the stroke that covers most of it."""
        if pixels.shape != self._shape:
            self._prepare(pixels.shape)
        ends = _contiguous(mark.start), _contiguous(mark.end)
        scratch = self._cover, self._touched
        self._kernels.draw_strokes(pixels, *scratch, clip, *ends, mark.width, colour, mark.colour[3])

    def fills(self, pixels: Pixels, clip: Clip, mark: Fills, colour: np.uint32) -> None:
        """Blend polygons, one over the other."""
        corners = np.minimum(np.maximum(np.rint(mark.corners), -_FARTHEST), _FARTHEST).astype(np.int64)
        self._kernels.fill_polygons(pixels, clip, np.ascontiguousarray(corners), colour, mark.colour[3])

    def bars(self, pixels: Pixels, clip: Clip, mark: Bars, colour: np.uint32) -> None:
        """Blend rectangles, one over the other."""
        places = _contiguous(mark.start), _contiguous(mark.end), _contiguous(mark.rise)
        self._kernels.draw_bars(pixels, clip, *places, colour, mark.colour[3])

    def discs(self, pixels: Pixels, clip: Clip, mark: Discs, ink: np.uint32, hollow: np.uint32) -> None:
        """Blend discs, one over the other."""
        places = _contiguous(mark.at), _contiguous(mark.radius)
        colours = ink, mark.ink[3], hollow, mark.hollow[3]
        self._kernels.draw_discs(pixels, clip, *places, mark.rim, *colours)


def _contiguous(numbers: NDArray[Any]) -> NDArray[np.float64]:
    return np.ascontiguousarray(numbers, dtype=np.float64)


@cache
def load_raster() -> Raster:
    """The compiled drawing; compiling it takes some seconds."""
    return Raster(RASTER.load())


def _contents() -> tuple[str, dict[str, Callable[..., Any]]]:
    lines = ["from pinjoint.systems.program.kernel import kept", ""]
    for name, signature in SIGNATURES.items():
        parameters = ", ".join(inspect.signature(getattr(kernels, name)).parameters)
        lines += [f'@kept("{signature}")', f"def {name}({parameters}):", f"    {name}_kernel({parameters})", ""]
    return "\n".join(lines), {f"{name}_kernel": getattr(kernels, name) for name in SIGNATURES}


RASTER = GeneratedModule("raster", _contents)


# --- few strokes, without compiled code ---------------------------------------------------------------


def stroke_coverage(
    start: Points, end: Points, width: float
) -> tuple[NDArray[np.int32], NDArray[np.int32], NDArray[np.uint8]]:
    """Columns, rows and coverage (1 to 255) of the pixels that strokes from `start` to `end` touch.

    In every column of a flat stroke (every row of a steep one) the stroke covers the interval of height
    width / cos(slope) about its middle line; a pixel's coverage is its share of that interval. Pixels
    come in ascending coverage, so that where strokes cross, the last one written covers most.
    """
    delta = end - start
    steep = np.abs(delta[:, 1]) > np.abs(delta[:, 0])
    along = np.where(steep, 1, 0)
    row = np.arange(len(start))
    backwards = delta[row, along] < 0.0
    first = np.where(backwards[:, None], end, start)
    last = np.where(backwards[:, None], start, end)
    m0, m1 = first[row, along], last[row, along]
    length = np.hypot(delta[:, 0], delta[:, 1])
    reach = np.maximum(m1 - m0, 1e-9)
    slope = (last[row, 1 - along] - first[row, 1 - along]) / reach
    half = (0.5 * width * length / reach).astype(np.float32)

    base = np.floor(m0).astype(np.int32)
    count = np.floor(m1).astype(np.int32) - base + 1
    of = np.repeat(row, count)
    step = np.arange(len(of), dtype=np.int32) - np.repeat(np.cumsum(count) - count, count).astype(np.int32)
    major = base[of] + step
    ends = np.minimum(major + 1, m1[of]) - np.maximum(major, m0[of])  # share of this column that it crosses
    middle = (first[row, 1 - along] + (base + 0.5 - m0) * slope)[of] + step * slope[of]
    low = np.floor(middle - half[of]).astype(np.int32)
    offset = (middle - low).astype(np.float32)[:, None]
    pixels = np.arange(int(np.ceil(2.0 * half.max(initial=0.0))) + 1, dtype=np.float32)
    thickness = half[of][:, None]
    share = np.minimum(pixels + 1.0, offset + thickness) - np.maximum(pixels, offset - thickness)
    amount = (np.clip(share, 0.0, 1.0) * (255.0 * ends.astype(np.float32))[:, None] + 0.5).astype(np.uint8)

    touched = np.flatnonzero(amount)
    touched = touched[np.argsort(amount.ravel()[touched], kind="stable")]
    sample, pixel = np.divmod(touched, len(pixels))
    minor = low[sample] + pixel.astype(np.int32)
    is_steep = steep[of[sample]]
    x, y = np.where(is_steep, minor, major[sample]), np.where(is_steep, major[sample], minor)
    return x, y, amount.ravel()[touched]
