"""Camera: which part of the plane is seen, and where on the screen. y is up in the model, down in pixels."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from pinjoint.components.field import Vector

_DEFAULT_SCALE = 100.0  # points per metre at the default zoom
LEAST_MARGIN = 0.2  # of the room, where a margin would take more
SMALLEST_SCALE, LARGEST_SCALE = 1e-6, 1e9


@dataclass(frozen=True)
class Rectangle:
    """A rectangle of the window, in pixels, y down."""

    left: float
    top: float
    width: float
    height: float

    @property
    def right(self) -> float:
        return self.left + self.width

    @property
    def bottom(self) -> float:
        return self.top + self.height

    @property
    def middle(self) -> Vector:
        """The pixel in the middle."""
        return self.left + self.width / 2.0, self.top + self.height / 2.0

    @property
    def box(self) -> tuple[float, float, float, float]:
        """Left, top, width and height."""
        return self.left, self.top, self.width, self.height

    @property
    def corners(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """The top left and the bottom right corner, each (2,)."""
        return np.array([self.left, self.top], dtype=np.float64), np.array(
            [self.right, self.bottom], dtype=np.float64
        )

    def contains(self, pixel: Vector) -> bool:
        """True if the pixel lies inside."""
        x, y = pixel
        return self.left <= x < self.right and self.top <= y < self.bottom


@dataclass(frozen=True)
class Viewport(Rectangle):
    """The part of the window in which something is shown."""

    left: int = 0
    top: int = 0
    width: int = 600
    height: int = 600


@dataclass
class Camera:
    """Looks at `centre` (m) with `scale` pixels per metre through `viewport`."""

    centre: Vector = (0.0, 0.0)
    scale: float = _DEFAULT_SCALE
    viewport: Viewport = field(default_factory=Viewport)

    @property
    def middle(self) -> Vector:
        """The pixel in the middle of the viewport."""
        return self.viewport.middle

    @np.errstate(over="ignore", invalid="ignore")
    def to_pixels(self, points: ArrayLike) -> NDArray[np.float64]:
        """Model points (m), shape (..., 2), as pixels."""
        points = np.asarray(points, dtype=np.float64)
        pixels = np.empty_like(points)  # by columns: numpy is slow along an axis of two
        pixels[..., 0] = self.middle[0] + (points[..., 0] - self.centre[0]) * self.scale
        pixels[..., 1] = self.middle[1] - (points[..., 1] - self.centre[1]) * self.scale
        return pixels

    def to_model(self, pixel: Vector) -> Vector:
        """A pixel as a model point (m)."""
        middle = self.middle
        return (
            float(self.centre[0] + (pixel[0] - middle[0]) / self.scale),
            float(self.centre[1] - (pixel[1] - middle[1]) / self.scale),
        )

    def zoom(self, factor: float, at: Vector) -> None:
        """Zoom so that the model point under pixel `at` stays there."""
        before = self.to_model(at)
        self.scale = min(max(self.scale * factor, SMALLEST_SCALE), LARGEST_SCALE)
        after = self.to_model(at)
        self.centre = (self.centre[0] + before[0] - after[0], self.centre[1] + before[1] - after[1])

    def pan(self, pixels: Vector) -> None:
        """Move the picture by pixels (right, down)."""
        self.centre = (self.centre[0] - pixels[0] / self.scale, self.centre[1] + pixels[1] / self.scale)

    def fit(
        self,
        points: NDArray[np.float64],
        margin: float = 110.0,
        within: Viewport | None = None,
        unit: float = 1.0,
    ) -> None:
        """Show all points, shape (n, 2), with a margin in points (less where there is little room).

        within: the part of the viewport to show them in, if not all of it. unit: pixels per point.
        """
        room = within or self.viewport
        points = points[np.isfinite(points).all(axis=1)]
        if len(points) == 0:
            self.centre, self.scale = (0.0, 0.0), _DEFAULT_SCALE * unit
        else:
            self._fit(points, margin * unit, room, (4.0 if len(points) > 1 else 1.0) * _DEFAULT_SCALE * unit)
        (x, y), (there_x, there_y) = self.middle, room.middle
        self.pan((there_x - x, there_y - y))

    def _fit(self, points: NDArray[np.float64], margin: float, within: Viewport, largest: float) -> None:
        low, high = points.min(axis=0), points.max(axis=0)
        size = np.array([within.width, within.height], dtype=np.float64)
        room = np.maximum(size - 2.0 * np.minimum(margin, LEAST_MARGIN * size), 1.0)
        extent = np.maximum(high - low, 1e-9)
        scale = float((room / extent).min())
        self.centre = (float((low[0] + high[0]) / 2), float((low[1] + high[1]) / 2))
        self.scale = min(max(scale, SMALLEST_SCALE), largest)
